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

  void add(double u, double v, double h, double weight = 1) {
    const double uu = u * u, uv = u * v, vv = v * v, wu = weight * u, wv = weight * v, wh = weight * h;
    const double wuu = weight * uu, wuv = weight * uv, wvv = weight * vv;
    const std::array<double, 15> more{weight,  wu,      wv,       wuu,      wuv,      wvv,      wuu * u, wuu * v,
                                      wvv * u, wvv * v, wuu * uu, wuu * uv, wuu * vv, wuv * vv, wvv * vv};
    for (std::size_t k = 0; k < more.size(); ++k) moments_[k] += more[k];
    const Terms t{wh, wh * u, wh * v, wh * uu, wh * uv, wh * vv};
    for (std::size_t k = 0; k < t.size(); ++k) right_[k] += t[k];
    squares_ += wh * h;
    points_ += 1;
  }
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
  // Sums of w u^a v^b: 1, u, v, u2, uv, v2, u3, u2v, uv2, v3, u4, u3v, u2v2, uv3, v4.
  std::array<double, 15> moments_{};
  Terms right_{};
  double squares_ = 0, points_ = 0;
};

}  // namespace gonio::mesh
