// See response_curve.h.
#include "photograph/response_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/picture.h"

namespace gonio::photograph {
namespace {

constexpr double per_code = 4, full = 255, soft_low = 4, soft_high = 20, middle = 127.5;
constexpr std::size_t places = static_cast<std::size_t>(full * per_code) + 1;

// Knots lie close at both ends, where curves have their toe and shoulder.
double warped(double code) {
  return std::log((code + soft_low) / (full + soft_high - code));
}
double unwarped(double v) {
  return ((full + soft_high) * std::exp(v) - soft_low) / (1 + std::exp(v));
}

// Uniform cubic B-splines that are not zero at the place: the first one, and their four values.
struct Basis {
  Eigen::Index first;
  std::array<double, 4> of;
};
Basis basis(double code) {
  const double from = warped(0), to = warped(full),
               at = (warped(code) - from) / (to - from) * (ResponseCurveShape::terms - 3);
  const auto i = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(at), 0, ResponseCurveShape::terms - 4);
  const double u = at - static_cast<double>(i), v = 1 - u;
  return {i, {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6}};
}

}  // namespace

ResponseCurveShape::ResponseCurveShape() {
  Eigen::VectorXd q(terms);
  const double from = warped(0), apart = (warped(full) - from) / (terms - 3);
  for (Eigen::Index i = 0; i < terms; ++i)
    q[i] = std::log(2.2 / (unwarped(from + (static_cast<double>(i) - 1) * apart) + soft_low));
  set(q);
}

void ResponseCurveShape::set(const Eigen::VectorXd& coefficients) {
  q_ = coefficients;
  value_.assign(places, 0), slope_.assign(places, 0);
  gradient_ = Eigen::MatrixXd::Zero(terms, static_cast<Eigen::Index>(places));
  Eigen::VectorXd last = Eigen::VectorXd::Zero(terms);
  for (std::size_t k = 0; k < places; ++k) {
    const Basis b = basis(static_cast<double>(k) / per_code);
    double q = 0;
    for (std::size_t i = 0; i < 4; ++i) q += b.of[i] * q_[b.first + static_cast<Eigen::Index>(i)];
    slope_[k] = std::exp(q);
    Eigen::VectorXd own = Eigen::VectorXd::Zero(terms);
    for (std::size_t i = 0; i < 4; ++i) own[b.first + static_cast<Eigen::Index>(i)] = slope_[k] * b.of[i];
    if (k > 0) {
      const auto at = static_cast<Eigen::Index>(k);
      value_[k] = value_[k - 1] + (slope_[k - 1] + slope_[k]) / (2 * per_code);
      gradient_.col(at) = gradient_.col(at - 1) + (last + own) / (2 * per_code);
    }
    last = own;
  }
  const auto zero = static_cast<std::size_t>(middle * per_code);
  const double at_zero = value_[zero];
  for (double& v : value_) v -= at_zero;
  gradient_.colwise() -= Eigen::VectorXd(gradient_.col(static_cast<Eigen::Index>(zero)));
}

double ResponseCurveShape::value(double code) const {
  const double at = std::clamp(code, 0.0, full) * per_code;
  const auto i = std::min(static_cast<std::size_t>(at), places - 2);
  const double share = at - static_cast<double>(i);
  return value_[i] * (1 - share) + value_[i + 1] * share;
}

double ResponseCurveShape::slope(double code) const {
  const double at = std::clamp(code, 0.0, full) * per_code;
  const auto i = std::min(static_cast<std::size_t>(at), places - 2);
  const double share = at - static_cast<double>(i);
  return slope_[i] * (1 - share) + slope_[i + 1] * share;
}

double ResponseCurveShape::code(double value) const {
  const auto above = std::ranges::upper_bound(value_, value);
  if (above == value_.begin()) return 0;
  if (above == value_.end()) return full;
  const auto i = static_cast<std::size_t>(above - value_.begin()) - 1;
  return (static_cast<double>(i) + (value - value_[i]) / (value_[i + 1] - value_[i])) / per_code;
}

Eigen::VectorXd ResponseCurveShape::gradient(double code) const {
  const double at = std::clamp(code, 0.0, full) * per_code;
  const auto i = std::min(static_cast<std::size_t>(at), places - 2);
  const double share = at - static_cast<double>(i);
  const auto column = static_cast<Eigen::Index>(i);
  return gradient_.col(column) * (1 - share) + gradient_.col(column + 1) * share;
}

std::vector<ResponseRow> rows_of(const ResponseCurveShape& shape, const Eigen::MatrixXd& covariance, double lowest,
                                 double highest) {
  constexpr double finest = 24;  // rows between a code and its double are about 17
  const double scale = io::linear_from_srgb(static_cast<float>(middle / full));
  const auto row = [&](double code) {
    const Eigen::VectorXd by = shape.gradient(code);
    const double linear = scale * std::exp(shape.value(code));
    return ResponseRow{code / full, linear, linear * std::sqrt(std::max(0.0, by.dot(covariance * by)))};
  };
  std::vector<ResponseRow> rows;
  for (double code = 0; code <= full;) {
    const ResponseRow edge = row(std::clamp(code, lowest, highest));
    const double on = code < lowest ? -edge.linear * (1 - code / lowest)
                                    : std::max(0.0, code - highest) * edge.linear * shape.slope(highest);
    rows.push_back({code / full, edge.linear + on, edge.sigma + std::abs(on)});
    if (code == full) break;
    code = std::min(full, code + std::max(1.0, std::floor(code / finest)));
  }
  return rows;
}

}  // namespace gonio::photograph
