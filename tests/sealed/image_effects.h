// What photographs of a scene may lack: effects of lamps, optics, sensor, surfaces, geometry and transport.
#pragma once
#include "sealed/world.h"

namespace gonio::sealed {

// `white`: the brightest reading of the series, known once the scene is designed.
std::vector<EffectKind> image_effects(const double* white);

}  // namespace gonio::sealed
