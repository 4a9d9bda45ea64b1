// See normals.h.
#include "relief/normals.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geom/vector.h"
#include "relief/areal.h"

namespace gonio::relief {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

struct Slopes {
  std::vector<double> x, y;  // one per point, NaN in the last row and column and about gaps
  std::size_t count = 0;
};
Slopes slopes_of(const io::HeightMap& map) {
  Slopes s{std::vector<double>(map.z_m.size(), missing), std::vector<double>(map.z_m.size(), missing), 0};
  for (std::size_t y = 0; y + 1 < map.height; ++y)
    for (std::size_t x = 0; x + 1 < map.width; ++x) {
      const double a = map.at(x, y), b = map.at(x + 1, y), c = map.at(x, y + 1), d = map.at(x + 1, y + 1);
      if (!std::isfinite(a + b + c + d)) continue;
      s.x[y * map.width + x] = (b + d - a - c) / (2 * map.step_x_m);
      s.y[y * map.width + x] = (a + b - c - d) / (2 * map.step_y_m);  // rows run down
      ++s.count;
    }
  return s;
}

using Form = Eigen::Matrix2d;  // M
using Three = Eigen::Vector3d;

double q_of(const Form& inverse, double x, double y) {
  return inverse(0, 0) * x * x + 2 * inverse(0, 1) * x * y + inverse(1, 1) * y * y;
}
double weight(bool ggx, double q) {
  return ggx ? 4 / (1 + q) : 2;
}
Form form_of(const Three& m) {
  return (Form() << m[0], m[1], m[1], m[2]).finished();
}

// <w s s'> as (xx, xy, yy)
Three weighted(const Slopes& s, const Form& m, bool ggx) {
  const Form inverse = m.inverse();
  Three sum = Three::Zero();
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const double x = s.x[i], y = s.y[i];
    if (std::isfinite(x)) sum += weight(ggx, q_of(inverse, x, y)) * Three(x * x, x * y, y * y);
  }
  return sum / static_cast<double>(s.count);
}

// alpha_u, alpha_v, azimuth
Three axes_of(const Three& m) {
  const double middle = 0.5 * (m[0] + m[2]), half = std::hypot(0.5 * (m[0] - m[2]), m[1]);
  return {std::sqrt(middle + half), std::sqrt(std::max(0.0, middle - half)), 0.5 * std::atan2(2 * m[1], m[0] - m[2])};
}

Eigen::Matrix3d covariance_of(const io::HeightMap& map, const Slopes& s, const Three& m, bool ggx) {
  const Form inverse = form_of(m).inverse();
  std::vector<std::vector<double>> g(3, std::vector<double>(s.x.size(), missing));
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const double x = s.x[i], y = s.y[i];
    if (!std::isfinite(x)) continue;
    const double w = weight(ggx, q_of(inverse, x, y));
    g[0][i] = w * x * x - m[0], g[1][i] = w * x * y - m[1], g[2][i] = w * y * y - m[2];
  }
  const MeanVariance v = variance_of_means(g, map.width, map.height);
  Eigen::Matrix3d slope;  // of <g> by M
  for (int k = 0; k < 3; ++k) {
    Three up = m, down = m;
    const double step = 1e-4 * std::sqrt(m[0] * m[2]);
    up[k] += step, down[k] -= step;
    slope.col(k) = ((weighted(s, form_of(up), ggx) - up) - (weighted(s, form_of(down), ggx) - down)) / (2 * step);
  }
  const Eigen::Matrix3d bread = slope.inverse();
  return bread * Eigen::Map<const Eigen::Matrix3d>(v.covariance.data()) * bread.transpose();
}

SlopeFit fitted(const io::HeightMap& map, const Slopes& s, bool ggx) {
  constexpr int most_rounds = 300;
  Three m = weighted(s, Form::Identity(), false);
  // a relief that is flat along one direction keeps a trace of width there
  const double least = 1e-9 * (m[0] + m[2]) + 1e-30;
  m[0] += least, m[2] += least;
  for (int round = 0; ggx && round < most_rounds; ++round) {
    const Three next = weighted(s, form_of(m), true) + Three(least, 0, least);
    const double change = (next - m).norm();
    m = next;
    if (change < 1e-10 * m.norm()) break;
  }
  const Eigen::Matrix3d c = covariance_of(map, s, m, ggx);
  const Three axes = axes_of(m);
  Eigen::Matrix3d turn;
  for (int k = 0; k < 3; ++k) {
    Three up = m, down = m;
    const double step = 1e-5 * std::sqrt(m[0] * m[2]);
    up[k] += step, down[k] -= step;
    turn.col(k) = axes_of(up) - axes_of(down);
    turn(2, k) = std::remainder(turn(2, k), pi);
    turn.col(k) /= 2 * step;
  }
  const Eigen::Matrix3d axes_covariance = turn * c * turn.transpose();
  SlopeFit fit;
  fit.distribution = ggx ? "ggx" : "beckmann";
  fit.alpha_u = axes[0], fit.alpha_v = axes[1], fit.azimuth_rad = axes[2];
  fit.sigma_alpha_u = std::sqrt(std::max(0.0, axes_covariance(0, 0)));
  fit.sigma_alpha_v = std::sqrt(std::max(0.0, axes_covariance(1, 1)));
  fit.sigma_azimuth_rad = std::min(pi / 2, std::sqrt(std::max(0.0, axes_covariance(2, 2))));
  const Form inverse = form_of(m).inverse();
  double sum = 0;
  for (std::size_t i = 0; i < s.x.size(); ++i)
    if (std::isfinite(s.x[i])) {
      const double q = q_of(inverse, s.x[i], s.y[i]);
      sum += ggx ? -2 * std::log1p(q) : -q;
    }
  fit.log_likelihood = sum / static_cast<double>(s.count) - std::log(pi * axes[0] * axes[1]);
  return fit;
}

}  // namespace

double SlopeFit::density(double sx, double sy) const {
  const double c = std::cos(azimuth_rad), n = std::sin(azimuth_rad);
  const double a = (c * sx + n * sy) / alpha_u, b = (c * sy - n * sx) / alpha_v, q = a * a + b * b;
  const double scale = pi * alpha_u * alpha_v;
  return distribution == "ggx" ? 1 / (scale * (1 + q) * (1 + q)) : std::exp(-q) / scale;
}

Normals normals_of(const io::HeightMap& map, int side) {
  const Slopes s = slopes_of(map);
  Normals n;
  n.reach = 1e-6, n.side = side, n.slopes = s.count;
  n.share.resize(static_cast<std::size_t>(side * side));
  std::vector<double> size;
  for (std::size_t i = 0; i < s.x.size(); ++i)
    if (std::isfinite(s.x[i])) size.push_back(std::max(std::abs(s.x[i]), std::abs(s.y[i])));
  if (size.empty()) return n;
  const auto most = size.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(size.size() - 1));
  std::nth_element(size.begin(), most, size.end());
  n.reach = std::max(1e-9, 1.1 * *most);
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (!std::isfinite(s.x[i])) continue;
    const double u = (s.x[i] / n.reach + 1) / 2 * side, v = (s.y[i] / n.reach + 1) / 2 * side;
    const double one = 1 / static_cast<double>(s.count);
    if (u >= 0 && v >= 0 && u < side && v < side)
      n.share[static_cast<std::size_t>(static_cast<int>(v) * side + static_cast<int>(u))] += one;
    else
      n.beyond += one;
  }
  if (*std::max_element(size.begin(), size.end()) <= 0) return n;
  for (const bool ggx : {true, false}) n.fits.push_back(fitted(map, s, ggx));
  if (n.fits[1].log_likelihood > n.fits[0].log_likelihood) std::swap(n.fits[0], n.fits[1]);
  return n;
}

}  // namespace gonio::relief
