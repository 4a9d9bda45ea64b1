// Drawing from a list of weights, and from a table of them row by row (Pharr, Jakob & Humphreys 2016, section 13.6.7).
// The search for an interval starts where a guide table says (Chen & Asau 1974): a step or two instead of a bisection
// all over the memory.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geom/vector.h"

namespace gonio::light {

// Running sums of non-negative weights, the first 0 and the last 1.
struct Distribution {
  std::vector<double> cumulative;
  double total = 0;
  explicit Distribution(const std::vector<double>& weights) : cumulative(weights.size() + 1) {
    for (std::size_t i = 0; i < weights.size(); ++i) cumulative[i + 1] = cumulative[i] + weights[i];
    total = cumulative.back();
    for (std::size_t i = 0; i < cumulative.size(); ++i)
      cumulative[i] = total > 0 ? cumulative[i] / total : static_cast<double>(i) / static_cast<double>(weights.size());
    cumulative.back() = 1;
    std::size_t i = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      while (cumulative[i + 1] * static_cast<double>(weights.size()) <= static_cast<double>(k)) ++i;
      guide_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  double share(std::size_t i) const { return cumulative[i + 1] - cumulative[i]; }
  // Index drawn by `u`, which is replaced by its position inside the interval.
  std::size_t draw(double& u) const {
    const std::size_t last = guide_.size() - 1;
    std::size_t i = guide_[std::min(static_cast<std::size_t>(u * static_cast<double>(guide_.size())), last)];
    while (i > 0 && cumulative[i] > u) --i;  // where the product has been rounded up
    while (i < last && cumulative[i + 1] <= u) ++i;
    u = share(i) > 0 ? std::clamp((u - cumulative[i]) / share(i), 0.0, 1.0) : 0.5;
    return i;
  }

 private:
  std::vector<std::uint32_t> guide_;  // the interval of k / n
};

// A table of weights: the row by its sum, then the column within the row.
class Distribution2 {
 public:
  struct Cell {
    std::size_t row, column;
    Vec2 inside;  // x along the row, y across the rows, each 0 .. 1
  };
  // `weights` in rows of `columns`.
  Distribution2(const std::vector<double>& weights, std::size_t columns) : rows_(sums(weights, columns)) {
    for (std::size_t first = 0; first < weights.size(); first += columns) {
      const auto from = weights.begin() + static_cast<std::ptrdiff_t>(first);
      row_.emplace_back(std::vector<double>(from, from + static_cast<std::ptrdiff_t>(columns)));
    }
  }
  Cell draw(Vec2 u) const {
    const std::size_t row = rows_.draw(u.x), column = row_[row].draw(u.y);
    return {row, column, {u.y, u.x}};
  }
  double share(std::size_t row, std::size_t column) const { return rows_.share(row) * row_[row].share(column); }
  double total() const { return rows_.total; }

 private:
  static std::vector<double> sums(const std::vector<double>& weights, std::size_t columns) {
    std::vector<double> result(weights.size() / columns);
    for (std::size_t i = 0; i < weights.size(); ++i) result[i / columns] += weights[i];
    return result;
  }
  std::vector<Distribution> row_;
  Distribution rows_;
};

}  // namespace gonio::light
