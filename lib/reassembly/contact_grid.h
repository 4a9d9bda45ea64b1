// Boxes in the plane, found by boxes: cells of the mean box's size, so that pairs that touch are met in time that grows
// with their number.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geom/vector.h"

namespace gonio::reassembly::contact {

struct PlaneBox {
  Vec2 low, high;
};
template <class... Points>
PlaneBox box_round(Vec3 first, Points... more) {
  PlaneBox b{{first.x, first.y}, {first.x, first.y}};
  for (const Vec3& p : {first, more...}) {
    b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y)};
    b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y)};
  }
  return b;
}

class BoxGrid {
 public:
  explicit BoxGrid(std::vector<PlaneBox> boxes) : boxes_(std::move(boxes)) {
    if (boxes_.empty()) return;
    bounds_ = boxes_.front();
    double extent = 0;
    for (const PlaneBox& b : boxes_) {
      bounds_.low = {std::min(bounds_.low.x, b.low.x), std::min(bounds_.low.y, b.low.y)};
      bounds_.high = {std::max(bounds_.high.x, b.high.x), std::max(bounds_.high.y, b.high.y)};
      extent += (b.high.x - b.low.x + b.high.y - b.low.y) / 2;
    }
    const Vec2 size = bounds_.high - bounds_.low;
    const auto count = static_cast<double>(boxes_.size());
    // No more cells than four a box, also where all boxes are points or lie on a line.
    cell_ = std::max({extent / count, std::sqrt(size.x * size.y / count) / 2, (size.x + size.y) / (2 * count), 1e-300});
    across_ = cells(size.x), down_ = cells(size.y);
    first_.assign(static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_) + 1, 0);
    for (const PlaneBox& b : boxes_) each_cell(range_of(b), [&](std::size_t c) { ++first_[c + 1]; });
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    held_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < boxes_.size(); ++i)
      each_cell(range_of(boxes_[i]), [&](std::size_t c) { held_[next[c]++] = i; });
  }

  // Every box that touches `query`, once.
  template <class Visit>
  void visit(const PlaneBox& query, const Visit& visit_one) const {
    if (boxes_.empty() || !touch(query, bounds_)) return;
    const auto asked = range_of(query);
    for (int y = asked[1]; y <= asked[3]; ++y)
      for (int x = asked[0]; x <= asked[2]; ++x) {
        const std::size_t c =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(x);
        for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
          const std::uint32_t i = held_[k];
          if (!touch(boxes_[i], query)) continue;
          const auto own = range_of(boxes_[i]);  // said by the first cell that both lie in, and by no other
          if (x == std::max(own[0], asked[0]) && y == std::max(own[1], asked[1])) visit_one(i);
        }
      }
  }

 private:
  static bool touch(const PlaneBox& a, const PlaneBox& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
  }
  int cells(double length) const { return 1 + static_cast<int>(std::min(length / cell_, 1e4)); }
  int cell_of(double offset, int count) const {
    return std::clamp(static_cast<int>(std::clamp(offset / cell_, 0.0, 1e4)), 0, count - 1);
  }
  std::array<int, 4> range_of(const PlaneBox& b) const {
    return {cell_of(b.low.x - bounds_.low.x, across_), cell_of(b.low.y - bounds_.low.y, down_),
            cell_of(b.high.x - bounds_.low.x, across_), cell_of(b.high.y - bounds_.low.y, down_)};
  }
  template <class Visit>
  void each_cell(const std::array<int, 4>& r, const Visit& visit_one) const {
    for (int y = r[1]; y <= r[3]; ++y)
      for (int x = r[0]; x <= r[2]; ++x)
        visit_one(static_cast<std::size_t>(y) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(x));
  }

  std::vector<PlaneBox> boxes_;
  PlaneBox bounds_{};
  double cell_ = 1;
  int across_ = 1, down_ = 1;
  std::vector<std::uint32_t> first_, held_;  // where each cell's boxes begin; boxes by cell
};

}  // namespace gonio::reassembly::contact
