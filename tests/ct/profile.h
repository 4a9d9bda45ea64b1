// Outlines of glassware for ct::lathe, and the body of a teapot.
#pragma once
#include <vector>

#include "ct/shape.h"

namespace gonio::ct {

// Points (r, z) of an ellipse of half-axes (a, b) about (0, z), at angles from `from` to `to`, moved outwards by
// `offset`.
std::vector<Vec2> arc(double a, double b, double z, double from, double to, double offset);
// A wall of even thickness inside of an arc.
std::vector<Vec2> wall_of(double a, double b, double z, double from, double to, double thickness);
std::vector<Vec2> ring_profile(double ring, double tube);  // a tube round the axis

// An ellipsoid of half-axes 0.27 and 0.23 of `extent` about the origin with a spout along +x, a handle at -x and an
// opening of radius 0.11 of `extent` at the top; its wall is `wall` thick.
struct TeapotSizes {
  double a, b, opening;
};
TeapotSizes teapot_sizes(double extent);
ShapePtr teapot_body(double extent, double wall);

}  // namespace gonio::ct
