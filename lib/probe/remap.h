// From one projection of the sphere to another, light conserved.
//
// A pixel is a patch of constant radiance. First-order conservative remapping (Jones, Monthly Weather Review 127,
// 1999): a new pixel is the mean of the old ones, weighed by the solid angles that they share, which are counted by
// sampling each new pixel, three samples a side to the smaller of the two pixels. So counted, an old pixel has not
// quite its own solid angle. What that takes from or adds to the light of pixels above the median radiance is given
// back where the pixel went, and what is left, some 1e-4, by one factor for all: the integral over the sphere is kept
// to rounding, a lamp keeps its light, and a constant picture stays constant.
#pragma once
#include <vector>

#include "io/image.h"
#include "probe/projection.h"

namespace gonio::probe {

// Solid angle of each pixel, sr, by rows; they sum to 4 pi. Zero outside of discs and faces.
std::vector<double> solid_angles(const SphereMap& map);
// `picture` lies in `from`, whose size is its own.
io::Image remapped(const io::Image& picture, const SphereMap& from, const SphereMap& to);

}  // namespace gonio::probe
