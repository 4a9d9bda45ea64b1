// The lamp that `point` and `sphere` share: a sphere of uniform radiance whose intensity on axis is I, or at radius 0 a
// point.
#pragma once
#include <memory>

#include "light/light.h"

namespace gonio::light {

std::unique_ptr<Emitter> sphere_emitter(Vec3 position_m, Rgb watt_per_sr, double radius_m);

}  // namespace gonio::light
