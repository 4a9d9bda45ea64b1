// Closed forms of irradiance (light/irradiance.h).
#include "light/irradiance.h"

#include <algorithm>
#include <cmath>
#include <vector>

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

Rgb lobe_irradiance(Rgb watt_per_sr, double exponent, Vec3 position_m, Vec3 axis, Vec3 point_m, Vec3 normal) {
  const Vec3 arm = point_m - position_m;
  const double length = norm(arm), cosine = length > 0 ? dot(axis, arm) / length : 0;
  if (!(cosine > 0)) return {};
  return point_irradiance(watt_per_sr * std::pow(cosine, exponent), position_m, point_m, normal);
}

Rgb disc_irradiance(Rgb radiance, double radius_m, double height_m, double offset_m) {
  const double r2 = radius_m * radius_m, b2 = offset_m * offset_m, arm2 = b2 + height_m * height_m;
  const double root = std::sqrt((arm2 + r2) * (arm2 + r2) - 4 * r2 * b2);
  return radiance * (pi / 2 * (1 - (arm2 - r2) / root));
}

Rgb polygon_irradiance(Rgb radiance, std::span<const Vec3> corners_m, Vec3 point_m, Vec3 normal) {
  std::vector<Vec3> above;  // clipped at the horizon (Sutherland & Hodgman 1974)
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const Vec3 a = corners_m[i] - point_m, b = corners_m[(i + 1) % corners_m.size()] - point_m;
    const double height_a = dot(a, normal), height_b = dot(b, normal);
    if (height_a >= 0) above.push_back(a);
    if ((height_a > 0 && height_b < 0) || (height_a < 0 && height_b > 0))
      above.push_back(a + (b - a) * (height_a / (height_a - height_b)));
  }
  double sum = 0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    const Vec3 across = cross(above[i], above[(i + 1) % above.size()]);
    const double sine = norm(across);
    if (sine > 0) sum += std::atan2(sine, dot(above[i], above[(i + 1) % above.size()])) * dot(across, normal) / sine;
  }
  return radiance * (std::abs(sum) / 2);
}

}  // namespace gonio::light
