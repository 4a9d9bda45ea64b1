// The module exact_distance (base/loaded_library.h): FCL's distances, as exact_distance.cpp asks for them.
#pragma once
#include <vector>

#include "acquisition/motion/body.h"

namespace gonio::acquisition {

class SurfaceDistances {
 public:
  virtual ~SurfaceDistances() = default;
  // Of the surfaces of two bodies in place; 0 or less where they meet. The point of `b` that is nearest to `a`, world
  // coordinates, where it is asked for: of two that are convex.
  virtual double between(std::size_t a, const PlacedBody& at_a, std::size_t b, const PlacedBody& at_b,
                         Vec3* nearest_on_b_m) const = 0;
};

}  // namespace gonio::acquisition

extern "C" {
// The caller's to delete.
const gonio::acquisition::SurfaceDistances* gonio_surface_distances(
    const std::vector<gonio::acquisition::Body>& bodies);
}
