// Heights over a tangent plane as a quadratic, h(u, v) = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2, by weighted least
// squares from running moments, so that a neighbourhood can grow and be fitted again. Exact for planes, balls up to
// fourth order, and whatever else is a quadratic: an even spread of noisy heights gives its slope without bias.
#pragma once
#include <array>

namespace gonio::mesh {

class LocalQuadratic {
 public:
  using Terms = std::array<double, 6>;
  static Terms terms(double u, double v) { return {1, u, v, u * u, u * v, v * v}; }

  void add(double u, double v, double h, double weight = 1);
  double points() const { return points_; }

  struct Fit {
    Terms c{};
    std::array<double, 36> inverse{};  // of the normal equations: covariance for noise of variance 1 (at weight 1)
    double residual = 0;               // weighted sum of squares
    bool good = false;                 // more than six points, not all on a conic
    double at(double u, double v) const;
    double variance_of_height() const { return inverse[0]; }
    double variance_of_slope(int i) const { return inverse[i == 0 ? 7 : 14]; }
  };
  Fit fit() const;

 private:
  std::array<double, 21> normal_{};  // lower triangle, row by row
  Terms right_{};
  double squares_ = 0, points_ = 0;
};

}  // namespace gonio::mesh
