// Pictures of all directions: how each projection lays the sphere on its pixels.
//
// Axes as `render` has them for its light "lat-long" at rotation 0: z up; the middle of a picture looks along +x, its
// right hand towards -y, its top towards +z, all seen from inside. "mirror-ball" is what a far camera that looks along
// +x photographs: its middle shows -x, its right edge what lies beyond -y, and all of the outline +x.
//   lat-long      equirectangular, twice as wide as high
//   angular       "light probe" of Debevec: the angle from +x grows with the distance from the middle, 180 degrees at
//                 the inscribed circle
//   mirror-ball   gamma = 2 asin(r), equal areas: 4 sr per unit of the disc
//   cube-cross    4 x 3 faces: the row left, front, right, back; up above front, down below it
//   cube-strip    6 x 1 faces: right, left, up, down, front, back, each as one sees it with the head up; up and down
//                 with front below and above
// Continuous pixel coordinates, corners at integers: the picture covers 0 to width, 0 to height.
#pragma once
#include <array>
#include <optional>
#include <string_view>

#include "geom/vector.h"

namespace gonio::probe {

enum class Projection { lat_long, angular, mirror_ball, cube_cross, cube_strip };
inline constexpr std::array<std::string_view, 5> projection_names = {"lat-long", "angular", "mirror-ball", "cube-cross",
                                                                     "cube-strip"};  // in this order

struct SphereMap {  // a projection at one size, pixels
  Projection projection = Projection::lat_long;
  int width = 0, height = 0;
};
// Width over height is fixed: 2, 1, 1, 4/3, 6. Error(data) at `place` for another one.
void check_shape(const SphereMap& picture, const char* place);
SphereMap sized(Projection projection, int height);  // cubes: rounded up to whole faces

struct Direction {
  Vec3 unit;
  double sr_per_px = 0;  // solid angle of a square pixel there, in the limit
};
std::optional<Direction> direction_at(const SphereMap& picture, Vec2 at);  // nothing outside of discs and faces
Vec2 place_of(const SphereMap& picture, Vec3 direction);

}  // namespace gonio::probe
