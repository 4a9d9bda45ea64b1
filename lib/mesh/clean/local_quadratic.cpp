#include "mesh/clean/local_quadratic.h"

#include <algorithm>
#include <cmath>

#include "linear/solve.h"

namespace gonio::mesh {

void LocalQuadratic::add(double u, double v, double h, double weight) {
  const Terms t = terms(u, v);
  std::size_t k = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double w = weight * t[i];
    for (std::size_t j = 0; j <= i; ++j) normal_[k++] += w * t[j];
    right_[i] += w * h;
  }
  squares_ += weight * h * h;
  points_ += 1;
}

LocalQuadratic::Fit LocalQuadratic::fit() const {
  Fit fit;
  if (points_ < 7) return fit;
  using Six = Eigen::Matrix<double, 6, 6>;
  Six a, unit;
  std::size_t k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) a(i, j) = a(j, i) = normal_[k++];
  unit.setIdentity();
  const Six inverse = linear::solve_ldlt(a, unit);
  fit.good = true;
  double explained = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      fit.inverse[static_cast<std::size_t>(6 * i + j)] = inverse(i, j);
      fit.c[static_cast<std::size_t>(i)] += inverse(i, j) * right_[static_cast<std::size_t>(j)];
    }
    // A direction that the points leave open has an inverse that is not the inverse.
    fit.good = fit.good && inverse(i, i) > 0 && std::isfinite(inverse(i, i)) &&
               std::abs(a.row(i).dot(inverse.col(i)) - 1) < 1e-6;
    explained += fit.c[static_cast<std::size_t>(i)] * right_[static_cast<std::size_t>(i)];
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
