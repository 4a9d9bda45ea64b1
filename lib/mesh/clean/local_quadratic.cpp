#include "mesh/clean/local_quadratic.h"

#include <algorithm>
#include <cmath>

#include "linear/positive.h"

namespace gonio::mesh {

LocalQuadratic::Fit LocalQuadratic::fit() const {
  Fit fit;
  if (points_ < 7) return fit;
  // Which moment stands where: of the terms 1, u, v, u2, uv, v2 with one another.
  constexpr std::array<std::size_t, 36> places{0, 1, 2, 3,  4,  5,  1, 3, 4, 6,  7,  8,  2, 4, 5, 7,  8,  9,
                                               3, 6, 7, 10, 11, 12, 4, 7, 8, 11, 12, 13, 5, 8, 9, 12, 13, 14};
  std::array<double, 36> a{};
  for (std::size_t k = 0; k < a.size(); ++k) a[k] = moments_[places[k]];
  fit.good = linear::positive_inverse<6>(a, fit.inverse);
  if (!fit.good) return fit;
  double explained = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    double one = 0;
    for (std::size_t j = 0; j < 6; ++j) {
      fit.c[i] += fit.inverse[6 * i + j] * right_[j];
      one += a[6 * i + j] * fit.inverse[6 * i + j];
    }
    // A direction that the points leave open has an inverse that is not the inverse.
    fit.good = fit.good && std::isfinite(one) && std::abs(one - 1) < 1e-6;
    explained += fit.c[i] * right_[i];
  }
  fit.residual = std::max(0.0, squares_ - explained);
  return fit;
}

double LocalQuadratic::Fit::at(double u, double v) const {
  const Terms t = terms(u, v);
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += c[i] * t[i];
  return sum;
}

}  // namespace gonio::mesh
