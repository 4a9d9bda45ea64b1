// Light that enters before it comes back: structured-light.subsurface.
//
// A scatterer at the depth d below the foot F of a flat surface is lit through the point where the projector's
// refracted ray enters, F + d s(wi), and seen through the one where the ray to the camera leaves, F + d s(wo), with
//   s(w) = t / sqrt(index^2 - |t|^2),   t = w - (w . n) n,
// the tangent of the refracted angle along the surface. What a camera sees at X was so lit at X + d (s(wi) - s(wo));
// two cameras see what one projector's pixel lit at places that are apart by the same with both of their directions.
//
// Light that scatters often comes back from around where it entered, by a law R over the surface. Of E exp(i theta), E
// the irradiance and theta a pattern's phase, a camera reads what R gathers about X. To first order in grad log E and
// in the second derivatives H of theta, k = grad theta and R^ the transform of R, its phase is turned by
//   - grad log E . grad R^(k) / R^(k) - trace(H grad grad R^(k)) / (2 R^(k)).
// Diffusion beneath a plane without absorption has R^ = exp(-m |k|), m the mean depth of sources and their images: with
// e = k / |k|, and H along e and across it, by
//   m grad log E . e + m H_across / (2 |k|) - m^2 H_along / 2:
// the brighter side tells more. Absorption takes from long ways: that of cosines longer than those it leaves is less.
// A camera's picture is as much spread for another camera: two of them do not see it.
#pragma once
#include <array>
#include <cmath>

#include "geom/vector.h"

namespace gonio::equation {

inline constexpr double subsurface_index =
    1.5;  // marble, skin, plastics: 1.4 to 1.6, which moves s by less than d does

// n and w unit vectors, w towards the device.
inline Vec3 refracted_slope(Vec3 n, Vec3 w) {
  const Vec3 t = w - dot(w, n) * n;
  return t * (1 / std::sqrt(subsurface_index * subsurface_index - dot(t, t)));
}
// By how much the place that the second device lights (or sees) lies from the one that the first sees.
inline Vec3 structured_light_subsurface(Vec3 n, Vec3 to_first, Vec3 to_second, double depth_m, double exit_depth_m) {
  return depth_m * refracted_slope(n, to_second) - exit_depth_m * refracted_slope(n, to_first);
}
// Radians. Derivatives along the surface: of log E, 1/m; of the phase, rad/m; of that, xx, xy and yy, rad/m^2.
inline double structured_light_spread(Vec2 log_irradiance, Vec2 phase, const std::array<double, 3>& bend,
                                      double spread_m) {
  const double k = std::hypot(phase.x, phase.y);
  if (!(k > 0)) return 0;
  const Vec2 e = phase * (1 / k);
  const double along = bend[0] * e.x * e.x + 2 * bend[1] * e.x * e.y + bend[2] * e.y * e.y,
               across = bend[0] + bend[2] - along;
  return spread_m * (dot(log_irradiance, e) + 0.5 * across / k - 0.5 * spread_m * along);
}

}  // namespace gonio::equation
