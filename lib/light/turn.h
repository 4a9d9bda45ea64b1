// light.direction: a lamp that hangs a little to the side of where the base model believes it to be.
#pragma once
#include "geom/vector.h"

namespace gonio::light {

// `towards` (unit, from the scene to the light) turned by the rotation vector tilt_x t + tilt_y b (Rodrigues; rad),
// where t, b are the axes x and y carried along as +z is taken to `towards` (geom/vector.h: Basis). Both axes stand at
// right angles to the direction, so neither tilt is ever without effect. Unchanged to the last bit where both are zero.
Vec3 turned(Vec3 towards, double tilt_x_rad, double tilt_y_rad);

// A position turned about `centre_m` in the same way; its distance from the centre stays.
Vec3 turned_about(Vec3 position_m, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m);

// A direction that belongs to the lamp at `position_m`, carried along as turned_about() moves it.
Vec3 turned_with(Vec3 direction, Vec3 position_m, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m);

}  // namespace gonio::light
