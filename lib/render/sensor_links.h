// The equations of the links of render/sensor_chain.h, for whoever follows a value through the chain. `v`: linear, in
// the picture's unit. Each returns v to the last bit at its neutral amount.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::render {

inline double with_veil(double v, double share, double mean_of_picture) {
  return v + share * mean_of_picture;
}
// `mirrored`: the value of the point opposite about the picture's centre.
inline double with_ghost(double v, double share, double mirrored) {
  return v + share * mirrored;
}
// One band of three; `sum` of all bands.
inline double with_crosstalk(double v, double share, double sum) {
  return (1 - 3 * share) * v + share * sum;
}
inline double with_fixed_pattern(double v, double sigma, double normal_of_pixel) {
  return v * (1 + sigma * normal_of_pixel);
}
// The shutter stays open `extra_s` longer than was set.
inline double with_shutter(double v, double extra_s, double exposure_s) {
  return v * (1 + extra_s / exposure_s);
}
inline double with_rows(double v, double amplitude, double period_px, double phase_rad, int row) {
  return v * (1 + amplitude * std::sin(2 * pi * row / period_px + phase_rad));
}
inline double with_limit(double v, double full_scale) {
  return full_scale > 0 ? std::min(v, full_scale) : v;
}
// What the pixel at `offset` (-1, 0, 1) weighs along one axis in a box of `width_px` pixels, 1 to 3.
inline double resampling_weight(int offset, double width_px) {
  return (offset == 0 ? 1 : 0.5 * (width_px - 1)) / width_px;
}

}  // namespace gonio::render
