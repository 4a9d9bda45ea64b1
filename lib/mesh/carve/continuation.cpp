#include "mesh/carve/continuation.h"

#include <algorithm>
#include <cmath>

#include "linear/solve.h"

namespace gonio::mesh {
namespace {

constexpr std::array<int, 3> degrees{1, 2, 4};
constexpr std::size_t samples_per_term = 4;

std::size_t terms_of(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
}

Eigen::VectorXd monomials(int degree, double u, double v) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(terms_of(degree)));
  Eigen::Index k = 0;
  for (int total = 0; total <= degree; ++total)
    for (int b = 0; b <= total; ++b) all[k++] = std::pow(u, total - b) * std::pow(v, b);
  return all;
}

}  // namespace

Continuation::Fit Continuation::fit(const std::vector<HeightSample>& band, double reach, int degree) {
  const auto terms = static_cast<Eigen::Index>(terms_of(degree));
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  for (const HeightSample& s : band) {
    const Eigen::VectorXd t = monomials(degree, s.u / reach, s.v / reach);
    a += t * t.transpose();
    right += t * s.h;
  }
  a.diagonal().array() += 1e-12 * a.trace() / static_cast<double>(terms);
  const Eigen::MatrixXd inverse = linear::inverse(a);
  const Eigen::VectorXd solution = inverse * right;
  Fit fit;
  fit.coefficients.assign(solution.data(), solution.data() + terms);
  fit.inverse.assign(inverse.data(), inverse.data() + terms * terms);
  std::vector<double> left;
  double square = 0, beside = 0;
  for (const HeightSample& s : band) {
    left.push_back(s.h - monomials(degree, s.u / reach, s.v / reach).dot(solution));
    square += left.back() * left.back();
  }
  for (std::size_t i = 0; i < band.size(); ++i)
    for (const std::uint32_t j : band[i].beside) beside += left[i] * left[j];
  const auto n = static_cast<double>(band.size());
  fit.square = square / std::max(1.0, n - static_cast<double>(terms));
  fit.inflation = square > 0 ? std::clamp(1 + beside / square, 1.0, 8.0) : 1;
  return fit;
}

Continuation::Continuation(const std::vector<HeightSample>& band, double reach) : reach_(reach) {
  for (const int degree : degrees) {
    if (degree > 1 && band.size() < samples_per_term * terms_of(degree)) break;
    fits_.push_back(fit(band, reach, degree));
    degree_ = degree;
  }
}

double Continuation::value(const Fit& fit, double u, double v) const {
  const int degree = fit.coefficients.size() == 3 ? 1 : fit.coefficients.size() == 6 ? 2 : 4;
  const Eigen::VectorXd t = monomials(degree, u / reach_, v / reach_);
  double sum = 0;
  for (std::size_t i = 0; i < fit.coefficients.size(); ++i)
    sum += fit.coefficients[i] * t[static_cast<Eigen::Index>(i)];
  return sum;
}

double Continuation::at(double u, double v) const {
  return value(fits_.back(), u, v);
}

Vec3 Continuation::normal_at(double u, double v) const {
  const double h = 1e-4 * reach_;  // of a polynomial of degree four: central differences are good to 1e-8
  return normalized(Vec3{-(at(u + h, v) - at(u - h, v)) / (2 * h), -(at(u, v + h) - at(u, v - h)) / (2 * h), 1});
}

double Continuation::sigma_at(double u, double v) const {
  const Fit& last = fits_.back();
  const Eigen::VectorXd t = monomials(degree_, u / reach_, v / reach_);
  const auto terms = static_cast<Eigen::Index>(last.coefficients.size());
  double variance = 0;
  for (Eigen::Index i = 0; i < terms; ++i)
    for (Eigen::Index j = 0; j < terms; ++j)
      variance += t[i] * t[j] * last.inverse[static_cast<std::size_t>(i * terms + j)];
  variance *= last.square * last.inflation;
  if (fits_.size() < 2) return std::sqrt(variance);
  const double step = std::abs(value(last, u, v) - value(fits_[fits_.size() - 2], u, v));
  double ratio = 1;
  if (fits_.size() > 2) {
    const double before = std::abs(value(fits_[1], u, v) - value(fits_[0], u, v));
    ratio = std::clamp(before > 0 ? step / before : 1, 0.05, 1.0);
  }
  return std::sqrt(variance + step * step * ratio * ratio);
}

}  // namespace gonio::mesh
