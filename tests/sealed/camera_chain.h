// From radiance to what a camera writes: optics, then the sensor, then its noise. Pictures are rows of RGB triples.
#pragma once
#include "base/random.h"
#include "sealed/world.h"

namespace gonio::sealed {

double size_of(const Sizes& sizes, const std::string& name, std::size_t part = 0);  // 0 where it is absent

// Falloff after cos^4 of the field angle, glare with a wide kernel, crosstalk, ripple of the mains over rows,
// pixels that differ, a response that bends as charge fills the wells, an offset, saturation; and, outside every
// library, amplifiers of columns that differ periodically. `picture`: which of a series (phases differ). `white`: the
// brightest reading of the series.
void through_camera(Numbers& rgb, int width, int height, const Sizes& sizes, std::size_t picture, double white);

// Photons (Poisson), read noise, gains of pixels that differ by 0.2 % and stay, 14 bits.
struct Sensor {
  double gain = 16000, read = 5e-4, pattern = 2e-3, white = 1;
  std::uint64_t seed = 1;  // of the pattern
};
double noise_sigma(const Sensor& sensor, double value);
void expose(const Sensor& sensor, Numbers& values, std::size_t per_picture, Random& random);

}  // namespace gonio::sealed
