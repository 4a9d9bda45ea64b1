// The shift that lays a pattern onto its picture (contrast/view_shift.h).
#include "contrast/view_shift.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace gonio::contrast {
namespace {

constexpr int points = 8;  // along a side of a cell

struct Sampled {
  double value = 0;
  Vec2 slope;
};

// Bilinear, with its derivative; nothing beyond the outermost pixels' centres.
std::optional<Sampled> sampled(const GreyView& view, Vec2 at) {
  const double x = std::floor(at.x), y = std::floor(at.y);
  if (!(x >= 0 && y >= 0 && x + 1 < view.width && y + 1 < view.height)) return std::nullopt;
  const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
  const auto below = i + static_cast<std::size_t>(view.width);
  if (view.saturated[i] || view.saturated[below]) return std::nullopt;
  const double a = view.value[i], b = view.value[i + 1], c = view.value[below], d = view.value[below + 1];
  const double s = at.x - x, t = at.y - y;
  return Sampled{(1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d),
                 {(1 - t) * (b - a) + t * (d - c), (1 - s) * (c - a) + s * (d - b)}};
}

struct Sums {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double squares = 0, count = 0;
};

Sums sums_at(const GreyView& view, const std::vector<Vec2>& pixels, const std::vector<double>& expected, Vec2 shift) {
  Sums sums;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double model = expected[i / (points * points)];
    const auto at = sampled(view, pixels[i] + shift);
    if (!at || !std::isfinite(model)) continue;
    const Eigen::Vector2d g(at->slope.x, at->slope.y);
    const double r = at->value - model;
    sums.normal += g * g.transpose();
    sums.slope += g * r;
    sums.squares += r * r;
    sums.count += 1;
  }
  return sums;
}

}  // namespace

ViewShift shift_onto(const GreyView& view, const CellPattern& pattern, const ViewMap& map,
                     const std::vector<double>& expected, double sigma_px) {
  std::vector<Vec2> pixels;
  const auto wide = static_cast<std::size_t>(pattern.columns);
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell)
    for (int k = 0; k < points * points; ++k) {
      const double x = static_cast<double>(cell % wide) + (k % points + 0.5) / points;
      const double y = static_cast<double>(cell / wide) + (k / points + 0.5) / points;
      pixels.push_back(map.pixel({x * pattern.cell_m.x, y * pattern.cell_m.y}).value_or(Vec2{-1e9, -1e9}));
    }
  const double side = std::max(shortest_side_px(pattern, map).value_or(1), 1e-3);
  const double shared = std::max(1.0, points * points / (side * side));
  ViewShift result{{}, sigma_px};
  if (!(sigma_px > 0)) return result;
  Vec2 shift;
  for (int round = 0; round < 30; ++round) {
    const Sums sums = sums_at(view, pixels, expected, shift);
    if (sums.count < 16 || !(sums.squares > 0)) return result;
    const double weight = sums.count / (sums.squares * shared), prior = 1 / (sigma_px * sigma_px);
    const Eigen::Matrix2d normal = sums.normal * weight + Eigen::Matrix2d::Identity() * prior;
    const Eigen::Vector2d slope = sums.slope * weight + Eigen::Vector2d(shift.x, shift.y) * prior;
    const Eigen::Vector2d step = -normal.ldlt().solve(slope);
    const double length = step.norm(), most = 0.5;
    shift = shift + Vec2{step(0), step(1)} * (length > most ? most / length : 1.0);
    result.sigma_px = std::sqrt(normal.inverse().diagonal().maxCoeff());
    if (length < 1e-3) {
      result.by_px = norm(shift) <= 4 * sigma_px ? shift : Vec2{};  // beyond, it fits something else
      return result;
    }
  }
  return {{}, sigma_px};
}

}  // namespace gonio::contrast
