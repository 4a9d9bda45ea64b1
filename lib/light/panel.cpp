#include "light/panel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::light {

std::optional<Panel::Meeting> Panel::meet(Vec3 origin_m, Vec3 direction) const {
  constexpr double least_cosine = 1e-9, edge = 1 + 1e-12;  // drawn points must not miss by rounding
  const double cosine = -dot(direction, frame.n);
  if (!(cosine > least_cosine)) return {};
  const double distance = dot(origin_m - centre_m, frame.n) / cosine;
  const Vec3 across = origin_m + direction * distance - centre_m;
  const double x = dot(across, frame.t), y = dot(across, frame.b);
  if (!(distance > 0) || std::abs(x) > width_m / 2 * edge || std::abs(y) > height_m / 2 * edge) return {};
  return Meeting{distance, cosine, x, y};
}

PanelView::PanelView(const Panel& panel, Vec3 point_m) : panel_(panel) {
  const Vec3 foot = panel.frame.to_local(point_m - panel.centre_m);
  height_m_ = foot.z;
  x0_ = -panel.width_m / 2 - foot.x;
  x1_ = panel.width_m / 2 - foot.x;
  y0_ = -panel.height_m / 2 - foot.y;
  y1_ = panel.height_m / 2 - foot.y;
  if (!seen()) return;
  // z of the unit normals of the planes through the point and each edge; the panel lies at z = -height.
  const double z = -height_m_;
  const double n0 = -y0_ / std::hypot(y0_, z), n1 = x1_ / std::hypot(x1_, z), n2 = y1_ / std::hypot(y1_, z),
               n3 = -x0_ / std::hypot(x0_, z);
  const auto angle = [](double a, double b) { return std::acos(std::clamp(-a * b, -1.0, 1.0)); };
  b0_ = n0;
  b1_ = n2;
  k_ = 2 * pi - angle(n2, n3) - angle(n3, n0);
  solid_angle_ = std::max(0.0, angle(n0, n1) + angle(n1, n2) - k_);
}

Vec2 PanelView::draw(Vec2 u) const {
  if (by_area()) return {(u.x - 0.5) * panel_.width_m, (u.y - 0.5) * panel_.height_m};
  const double z = -height_m_, turn = u.x * solid_angle_ + k_;
  const double f = (std::cos(turn) * b0_ - b1_) / std::sin(turn);
  const double c = std::clamp(std::copysign(1 / std::sqrt(f * f + b0_ * b0_), f), -1.0, 1.0);
  const double x = std::clamp(-(c * z) / std::sqrt(std::max(1e-300, 1 - c * c)), x0_, x1_);
  const double d = std::hypot(x, z), h0 = y0_ / std::hypot(d, y0_), h1 = y1_ / std::hypot(d, y1_);
  const double h = h0 + u.y * (h1 - h0);
  const double y = std::clamp(h * h < 1 ? h * d / std::sqrt(1 - h * h) : y1_, y0_, y1_);
  return {x - x0_ - panel_.width_m / 2, y - y0_ - panel_.height_m / 2};
}

}  // namespace gonio::light
