// Closed forms of irradiance (light/irradiance.h).
#include "light/irradiance.h"

#include <algorithm>
#include <cmath>

namespace gonio::light {

Rgb point_irradiance(Rgb watt_per_sr, Vec3 position_m, Vec3 point_m, Vec3 normal) {
  const Vec3 arm = position_m - point_m;
  const double square = dot(arm, arm);
  if (square == 0) return {};
  return watt_per_sr * (std::max(0.0, dot(normal, arm)) / (square * std::sqrt(square)));
}

Rgb sphere_irradiance(Rgb watt_per_sr, Vec3 position_m, double radius_m, Vec3 point_m, Vec3 normal) {
  const Vec3 arm = position_m - point_m;
  const double square = dot(arm, arm), sin2_s = radius_m * radius_m / square;
  if (square <= radius_m * radius_m) return {};
  const double cosine = dot(normal, arm) / std::sqrt(square);
  if (cosine * cosine >= sin2_s) return point_irradiance(watt_per_sr, position_m, point_m, normal);
  const double sine = std::sqrt(1 - cosine * cosine), x = std::sqrt(1 / sin2_s - 1);
  const double y = std::clamp(-x * cosine / sine, -1.0, 1.0), r = sine * std::sqrt(1 - y * y);
  const double solid = sin2_s * (cosine * std::acos(y) - x * r) + std::atan(r / x);
  return watt_per_sr * (std::max(0.0, solid) / (pi * radius_m * radius_m));
}

}  // namespace gonio::light
