// surface.coat: how much of a place is covered by a coat that ends at a plane of the object, in [0, 1].
//   cover = 1 / (1 + exp(-(d.x - from_m) / edge_m)),  d = (cos e cos a, cos e sin a, sin e)
// x in the object's frame, m; a and e azimuth and elevation of the plane's normal, which points into the covered part.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::surface {

struct CoatRegion {
  double azimuth_rad = 0, elevation_rad = 0, from_m = 0, edge_m = 1e-3;
  Vec3 towards() const {
    return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
            std::sin(elevation_rad)};
  }
  double cover(Vec3 position_m) const { return cover_at(dot(towards(), position_m)); }
  // The same, of a position's part along towards(): for many positions.
  double cover_at(double along_m) const {
    return 1 / (1 + std::exp(-std::clamp((along_m - from_m) / edge_m, -40.0, 40.0)));
  }
};

}  // namespace gonio::surface
