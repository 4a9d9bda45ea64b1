// See mirror_stage.h.
#include "sealed/mirror_stage.h"

#include <cmath>

namespace gonio::sealed {
namespace {

constexpr int facets = 160;

// What passes a sheet that absorbs along a line of its plane swings across that line and across its way.
Coherency shining(const Display& d, Vec3 travel) {
  const Vec3 absorbs = d.up * std::cos(d.angle) - d.right * std::sin(d.angle);
  return sent(travel, d.radiance, normalized(cross(absorbs, travel)), d.degree);
}

}  // namespace

Coherency Follower::from(Vec3 origin, Vec3 way, int depth) const {
  double nearest = 1e300;
  const MirrorBall* met = nullptr;
  for (const MirrorBall& ball : stage_.balls) {
    const Vec3 arm = origin - ball.centre;
    const double b = dot(arm, way), c = dot(arm, arm) - ball.radius * ball.radius, root = b * b - c;
    if (root <= 0) continue;
    const double t = -b - std::sqrt(root);
    if (t > 1e-7 && t < nearest) nearest = t, met = &ball;
  }
  for (const Display* display : {&stage_.screen, &stage_.panel}) {
    if (display == &stage_.panel && !panel_) continue;
    const double cosine = -dot(way, display->out);
    if (!(cosine > 0)) continue;
    const double t = -dot(display->centre - origin, display->out) / cosine;
    const Vec3 at = origin + way * t - display->centre;
    if (t <= 0 || t >= nearest || std::abs(dot(at, display->up)) > display->half ||
        std::abs(dot(at, display->right)) > display->half)
      continue;
    return shining(*display, way * -1.0);
  }
  if (met == nullptr || depth > 5) return {};
  const Vec3 at = origin + way * nearest, n = (at - met->centre) / met->radius;
  if (met->alpha == 0) return mirrored(*met, at, n, n, way, depth, 1);
  Coherency all;
  const int count = depth == 0 ? facets : 4;
  for (int k = 0; k < count; ++k) all = sum(all, rough(*met, at, n, way, depth, k, count), 1.0 / count);
  return all;
}

Coherency Follower::mirrored(const MirrorBall& ball, Vec3 at, Vec3 n, Vec3 h, Vec3 way, int depth,
                             double weight) const {
  const Vec3 on = way - h * (2 * dot(way, h));
  if (!(dot(on, n) > 0)) return {};
  const Coherency light = from(at + n * 1e-9, on, depth + 1);
  return sum({}, reflected(light, on * -1.0, way * -1.0, h, ball.mirror[band_], wavelengths[band_]), weight);
}

// A facet drawn by how much of the ground all such facets cover (Trowbridge & Reitz 1975), Smith's masking of both
// ways correlated by height.
Coherency Follower::rough(const MirrorBall& ball, Vec3 at, Vec3 n, Vec3 way, int depth, int k, int count) const {
  const double u = (k + random_.uniform()) / count, turn = 2 * pi * std::fmod(0.6180339887 * k + random_.uniform(), 1);
  const double tangent = ball.alpha * std::sqrt(u / (1 - u)), cosine = 1 / std::sqrt(1 + tangent * tangent);
  const Vec3 x = normalized(cross(n, std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), y = cross(n, x);
  const Vec3 h = n * cosine + (x * std::cos(turn) + y * std::sin(turn)) * (tangent * cosine);
  const double view = -dot(way, h), grazing = -dot(way, n);
  if (!(view > 0) || !(grazing > 0)) return {};
  const Vec3 on = way + h * (2 * view);
  const double leaving = dot(on, n);
  if (!(leaving > 0)) return {};
  const auto smith = [&](double c) { return 0.5 * (std::sqrt(1 + ball.alpha * ball.alpha * (1 / (c * c) - 1)) - 1); };
  const double seen = 1 / (1 + smith(grazing) + smith(leaving));
  return mirrored(ball, at, n, h, way, depth, seen * view / (grazing * cosine));
}

}  // namespace gonio::sealed
