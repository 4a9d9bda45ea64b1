// See patch.h. The step d of the patch's own warp is linear, with the light free: I(W(x)) = g T(x) + g T'(x) d + b.
#include "nrsfm/make/patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace gonio::nrsfm {
namespace {

// Between pixels, linear; none where the picture ends.
std::optional<double> value_at(const GreyPicture& picture, double x_px, double y_px) {
  const double x = x_px - 0.5, y = y_px - 0.5;
  if (!(x >= 0 && y >= 0 && x < picture.width - 1 && y < picture.height - 1)) return std::nullopt;
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
  const double u = x - static_cast<double>(column), v = y - static_cast<double>(row);
  const auto width = static_cast<std::size_t>(picture.width);
  const std::uint8_t* const at = picture.value.data() + row * width + column;
  return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * at[width] + u * at[width + 1]);
}

// A patch that a warp makes larger or smaller than this, or flatter, is no longer the one that was seen.
bool is_plausible(const Warp& warp) {
  const double area = warp.a.determinant(), size = warp.a.squaredNorm();
  return area > 0.2 && area < 5 && size < 8;
}

}  // namespace

std::optional<Patch> Patch::of(const GreyPicture& picture, const Eigen::Vector2d& place_px, int half_px) {
  Patch patch;
  patch.half_ = half_px;
  const Eigen::Index side = 2 * half_px + 1;
  patch.value_.resize(side * side);
  patch.columns_.resize(side * side, 8);
  Eigen::Index k = 0;
  for (int v = -half_px; v <= half_px; ++v)
    for (int u = -half_px; u <= half_px; ++u, ++k) {
      const double x = place_px.x() + u, y = place_px.y() + v;
      const auto here = value_at(picture, x, y), left = value_at(picture, x - 1, y),
                 right = value_at(picture, x + 1, y), above = value_at(picture, x, y - 1),
                 below = value_at(picture, x, y + 1);
      if (!left || !right || !above || !below) return std::nullopt;
      const double by_x = (*right - *left) / 2, by_y = (*below - *above) / 2;
      patch.value_(k) = *here;
      patch.columns_.row(k) << by_x * u, by_x * v, by_y * u, by_y * v, by_x, by_y, *here, 1;
    }
  patch.normal_.compute(patch.columns_.transpose() * patch.columns_);
  const Eigen::VectorXd pivots = patch.normal_.vectorD();
  if (pivots.minCoeff() < 1e-9 * pivots.maxCoeff()) return std::nullopt;
  return patch;
}

// Both pictures' noise is in the residuals; the step moves the place by A d / g, the mean of both axes.
double Patch::sigma_px(double residual_squares, double gain, const Warp& warp) const {
  Eigen::Matrix<double, 8, 2> axes = Eigen::Matrix<double, 8, 2>::Zero();
  axes(4, 0) = axes(5, 1) = 1;
  const Eigen::Matrix2d inverse = normal_.solve(axes).middleRows<2>(4);
  const double variance = residual_squares / (static_cast<double>(value_.size()) - 8) / (gain * gain);
  return std::sqrt(variance * (warp.a * inverse * warp.a.transpose()).trace() / 2);
}

std::optional<Fit> Patch::align(const GreyPicture& picture, Warp& warp) const {
  constexpr int most = 30;
  constexpr double enough_px = 0.01;
  Eigen::VectorXd seen(value_.size());
  for (int round = 0; round < most; ++round) {
    Eigen::Index k = 0;
    for (int v = -half_; v <= half_; ++v)
      for (int u = -half_; u <= half_; ++u, ++k) {
        const Eigen::Vector2d at = warp.a * Eigen::Vector2d(u, v) + warp.t;
        const auto value = value_at(picture, at.x(), at.y());
        if (!value) return std::nullopt;
        seen(k) = *value;
      }
    const Eigen::Matrix<double, 8, 1> fit = normal_.solve(columns_.transpose() * seen);
    const double gain = fit(6);
    if (!(gain > 0.2 && gain < 5)) return std::nullopt;
    Warp step;
    step.a << 1 + fit(0) / gain, fit(1) / gain, fit(2) / gain, 1 + fit(3) / gain;
    step.t << fit(4) / gain, fit(5) / gain;
    const Eigen::Matrix2d back = step.a.inverse();  // W becomes W o step^-1
    warp.t -= warp.a * back * step.t;
    warp.a *= back;
    if (!is_plausible(warp)) return std::nullopt;
    const double moved = step.t.norm() + half_ * (step.a - Eigen::Matrix2d::Identity()).norm();
    if (moved > enough_px && round + 1 < most) continue;
    const Eigen::VectorXd a = seen.array() - seen.mean(), b = value_.array() - value_.mean();
    const double likeness = a.dot(b) / std::sqrt(std::max(1e-12, a.squaredNorm() * b.squaredNorm()));
    return Fit{likeness, sigma_px((seen - columns_ * fit).squaredNorm(), gain, warp)};
  }
  return std::nullopt;
}

}  // namespace gonio::nrsfm
