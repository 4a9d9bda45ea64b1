// From sums over passes to a picture with named channels.
#pragma once
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/image.h"

namespace gonio::render {

class PassSums;

struct PixelGeometry {      // of the ray through the pixel's centre, but visibility: share of all samples' shadow rays
  Vec3 position_m, normal;  // world frame; zero where nothing is met
  int id = 0;               // instance + 1; 0: nothing
  std::vector<double> distance_m;  // to each light that is on; 0 where it is infinitely far
  std::vector<double> visibility;  // of each light that is on, 0 .. 1
};

// Channels of a plane as the integrator names it: "" is R, G, B; "light.NAME" is light.NAME.R, ...; a spectral plane is
// named by its three channels with blanks between them, of which a "-" is none.
std::vector<std::string> plane_channels(const std::string& plane);

// R, G, B, variance.R/G/B; then the other planes, variance.s1.R ... for Stokes vectors. Where `geometry` has channels
// (layers.h), they follow, with visibility.LIGHT and mask.A from the sums.
io::Image develop(const PassSums& sums, const io::Image& geometry);

// Of a picture by develop(): what `geometry` was.
io::Image geometry_of(const io::Image& picture);

}  // namespace gonio::render
