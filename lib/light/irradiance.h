// Irradiance in closed form, W/m^2, of unoccluded lights on a small plane at `point_m` with unit `normal`. The renderer
// does not use these; tests hold it against them, and explain's cached geometry uses them where nothing occludes.
#pragma once
#include <span>

#include "geom/vector.h"

namespace gonio::light {

// I cos / d^2, the point light's law.
Rgb point_irradiance(Rgb watt_per_sr, Vec3 position_m, Vec3 point_m, Vec3 normal);

// A sphere of uniform radiance L = I / (pi R^2). With d the distance of its centre, sin(s) = R / d its angular radius
// and theta the angle between the normal and its centre:
//   wholly above the horizon, cos(theta) >= sin(s):
//     E = pi L sin^2(s) cos(theta) = I cos(theta) / d^2, as for a point                       (Lambert 1760)
//   cut by the horizon, with x = cot(s), y = -x cot(theta), r = sin(theta) sqrt(1 - y^2):
//     E = L (sin^2(s) (cos(theta) acos(y) - x r) + atan(r / x))                 (Snyder 1996, MSR-TR-96-11)
//   wholly below: 0
// Zero for points inside the sphere.
Rgb sphere_irradiance(Rgb watt_per_sr, Vec3 position_m, double radius_m, Vec3 point_m, Vec3 normal);

// A small lamp of intensity I cos(theta)^exponent about the unit `axis`, nothing behind: I cos^exponent cos / d^2.
Rgb lobe_irradiance(Rgb watt_per_sr, double exponent, Vec3 position_m, Vec3 axis, Vec3 point_m, Vec3 normal);

// A disc of uniform radiance and radius R, on a plane parallel to it that faces it at the distance h, b away from the
// axis (a classical form factor: Siegel & Howell 1992, appendix C):
//   E = pi L / 2 (1 - (b^2 + h^2 - R^2) / sqrt((b^2 + h^2 + R^2)^2 - 4 R^2 b^2)),
// on the axis pi L R^2 / (R^2 + h^2) = pi L sin^2(s), tan(s) = R / h.
Rgb disc_irradiance(Rgb radiance, double radius_m, double height_m, double offset_m);

// A plane polygon of uniform radiance whose shining side faces the point (Lambert 1760): with unit vectors r_i to the
// corners of the part above the point's horizon, E = L / 2 |sum of angle(r_i, r_i+1) normalized(r_i x r_i+1) . n|.
Rgb polygon_irradiance(Rgb radiance, std::span<const Vec3> corners_m, Vec3 point_m, Vec3 normal);

}  // namespace gonio::light
