// The polarizers over the samples of a polarization camera as they are made: finite extinction, axes beside where they
// should be, light that reaches the sample beside, and a lens before them that delays one part of the light.
// Equations: photograph/mechanisms. Stokes frame: the picture's, y up (optics/mueller.h).
#pragma once
#include <array>

#include "geom/vector.h"

namespace gonio::photograph {

struct PolarizerArray {
  double leak = 0;      // polarizer.leak
  double turn_rad = 0;  // polarizer.angle: of all axes, and of these beside that of 0 degrees
  double turn_45_rad = 0, turn_90_rad = 0, turn_135_rad = 0;
  double share = 0;           // sensor.crosstalk, of each sample beside
  double retardance_rad = 0;  // lens.birefringence, half a picture's width from its axis
  bool ideal() const { return *this == PolarizerArray{}; }
  bool operator==(const PolarizerArray&) const = default;
};

// The sample at (x, y) reads the sum of these times the components of the Stokes vector that reaches the lens, before
// samples give light to each other. `radius`: from where the axis meets the picture, x right, y down, over half the
// picture's width.
std::array<double, 4> analyser(const PolarizerArray& array, int x, int y, Vec2 radius);

}  // namespace gonio::photograph
