// Relative intensity tabulated over the directions of a sphere, or of a part of it: a lobe for light/aimed.h.
//
// Colatitude from a pole and longitude about it, each ascending, rad; bilinear between, zero outside. A table of one
// longitude is symmetric about the pole. Photons are drawn cell by cell, by the mean of the cell's corners times its
// solid angle, and uniformly within:
//   pdf = share / ((cos(colatitude_i) - cos(colatitude_i+1)) (longitude_j+1 - longitude_j)).
#pragma once
#include <memory>
#include <vector>

#include "light/aimed.h"

namespace gonio::light {

struct SphericalGrid {
  std::vector<double> colatitude_rad;  // at least two, 0 .. pi
  std::vector<double> longitude_rad;   // one (symmetric), or at least two that span no more than 2 pi
  std::vector<double> value;           // [longitude][colatitude], not negative
  // Axes in the lamp's frame: longitude 0 lies along `zero`, pi / 2 along `quarter`.
  Vec3 pole{0, 0, 1}, zero{1, 0, 0}, quarter{0, 1, 0};
};

std::unique_ptr<const Lobe> tabulated_lobe(SphericalGrid grid);

}  // namespace gonio::light
