// A radius over a height as a turner cuts it: level at every knot, S-curves between, never beyond its knots.
#pragma once
#include <algorithm>
#include <vector>

#include "geom/vector.h"

namespace gonio::glass {

class TurnedCurve {
 public:
  explicit TurnedCurve(std::vector<Vec2> knots) : knots_(std::move(knots)) {}  // (z, r), z rising
  double operator()(double z) const {
    if (z <= knots_.front().x) return knots_.front().y;
    for (std::size_t i = 1; i < knots_.size(); ++i)
      if (z <= knots_[i].x) {
        const double t = (z - knots_[i - 1].x) / (knots_[i].x - knots_[i - 1].x);
        return knots_[i - 1].y + (knots_[i].y - knots_[i - 1].y) * t * t * (3 - 2 * t);
      }
    return knots_.back().y;
  }
  double slope(double z) const { return ((*this)(z + 1e-5) - (*this)(z - 1e-5)) / 2e-5; }

 private:
  std::vector<Vec2> knots_;
};

}  // namespace gonio::glass
