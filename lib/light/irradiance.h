// Irradiance in closed form, W/m^2, of unoccluded lights on a small plane at `point_m` with unit `normal`. The renderer
// does not use these; tests hold it against them, and explain's cached geometry uses them where nothing occludes.
#pragma once
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

}  // namespace gonio::light
