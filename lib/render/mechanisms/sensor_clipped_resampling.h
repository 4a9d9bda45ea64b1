// sensor.clipped-resampling: the weights of its box. What it mixes are readings of sensor.saturation.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_clipped_resampling();
}

namespace gonio::equation {

// What the pixel at `offset` (-1, 0, 1) weighs along one axis in a box of `width_px` native pixels, 1 to 3.
inline double sensor_clipped_resampling(int offset, double width_px) {
  return (offset == 0 ? 1 : 0.5 * (width_px - 1)) / width_px;
}

}  // namespace gonio::equation
