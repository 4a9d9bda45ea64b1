// Things in the plane by the square cells that their boxes touch, asked for from the cells about a place outwards.
// Private to alignment/.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geom/vector.h"

namespace gonio::alignment {

struct Box {
  Vec2 lower, upper;
};

class CellIndex {
 public:
  CellIndex() = default;
  CellIndex(const std::vector<Box>& boxes, double cell) : cell_(cell) {
    if (boxes.empty()) return;
    Vec2 upper{-HUGE_VAL, -HUGE_VAL};
    lower_ = {HUGE_VAL, HUGE_VAL};
    for (const Box& b : boxes) {
      lower_ = {std::min(lower_.x, b.lower.x), std::min(lower_.y, b.lower.y)};
      upper = {std::max(upper.x, b.upper.x), std::max(upper.y, b.upper.y)};
    }
    cell_ = std::max({cell_, (upper.x - lower_.x) / 1024, (upper.y - lower_.y) / 1024, 1e-9});
    columns_ = 1 + column(upper.x), rows_ = 1 + row(upper.y);
    starts_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (const Box& b : boxes) each(b, [&](std::size_t c) { ++starts_[c + 1]; });
    for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    members_.resize(starts_.back());
    std::vector<std::uint32_t> at(starts_.begin(), starts_.end() - 1);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) each(boxes[i], [&](std::size_t c) { members_[at[c]++] = i; });
  }
  // visit(i) of what may lie nearer to `p` than the root of `best`, which `visit` lowers; some come more than once.
  template <class Visit>
  void outwards(Vec2 p, double& best, const Visit& visit) const {
    if (members_.empty()) return;
    const int x0 = column(p.x), y0 = row(p.y), last = 1 + static_cast<int>(std::sqrt(best) / cell_);
    for (int ring = std::max({0, -x0, x0 - columns_ + 1, -y0, y0 - rows_ + 1}); ring <= last; ++ring) {
      const double least = (ring - 1) * cell_;
      if (least > 0 && least * least >= best) return;
      for (int y = std::max(0, y0 - ring); y <= std::min(rows_ - 1, y0 + ring); ++y) {
        const bool whole = y == y0 - ring || y == y0 + ring;
        for (int x = x0 - ring; x <= x0 + ring; x += whole ? 1 : std::max(1, 2 * ring)) {
          if (x < 0 || x >= columns_) continue;
          const std::size_t c = cell(x, y);
          for (std::uint32_t i = starts_[c]; i < starts_[c + 1]; ++i) visit(members_[i]);
        }
      }
    }
  }

 private:
  int column(double x) const { return static_cast<int>(std::floor(std::clamp((x - lower_.x) / cell_, -1e8, 1e8))); }
  int row(double y) const { return static_cast<int>(std::floor(std::clamp((y - lower_.y) / cell_, -1e8, 1e8))); }
  std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  template <class Visit>
  void each(const Box& b, const Visit& visit) const {
    for (int y = row(b.lower.y); y <= row(b.upper.y); ++y)
      for (int x = column(b.lower.x); x <= column(b.upper.x); ++x) visit(cell(x, y));
  }
  Vec2 lower_;
  double cell_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> starts_, members_;
};

}  // namespace gonio::alignment
