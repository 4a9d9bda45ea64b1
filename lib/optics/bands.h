// The three bands that one pass of the renderer carries in an `Rgb`: linear red, green and blue, or three wavelengths
// of a spectral rendering (N bins are ceil(N / 3) passes with the same random numbers). Wavelengths in metres, vacuum.
#pragma once
#include <array>

namespace gonio::optics {

struct Bands {
  bool rgb = true;
  std::array<double, 3> wavelength_m{};  // where not rgb
  bool operator==(const Bands&) const = default;
};

}  // namespace gonio::optics
