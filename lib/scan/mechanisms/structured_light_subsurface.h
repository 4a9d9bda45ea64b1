// Light that enters before it comes back: structured-light.subsurface.
//
// A scatterer at the depth d below the foot F of a flat surface is lit through the point where the projector's
// refracted ray enters, F + d s(wi), and seen through the one where the ray to the camera leaves, F + d s(wo), with
//   s(w) = t / sqrt(index^2 - |t|^2),   t = w - (w . n) n,
// the tangent of the refracted angle along the surface. What a camera sees at X was so lit at X + d (s(wi) - s(wo));
// two cameras see what one projector's pixel lit at places that are apart by the same with both of their directions.
#pragma once
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
inline Vec3 structured_light_subsurface(Vec3 n, Vec3 to_first, Vec3 to_second, double depth_m) {
  return depth_m * (refracted_slope(n, to_second) - refracted_slope(n, to_first));
}

}  // namespace gonio::equation
