// What else fits: a pose of which turns about the body's own axes look alike, and directions that no rim holds.
#pragma once
#include <string>
#include <vector>

#include "alignment/fit.h"

namespace gonio::alignment {

// "(0.00, 0.71, 0.71)": of an axis, which has no sign.
std::string axis_words(Vec3 axis);

// Middle and principal axes of the mesh's surface, mesh frame.
struct Axes {
  Vec3 middle_m;
  std::array<Vec3, 3> axis;
  std::array<double, 3> spread{};  // variances along them, m^2, falling
};
Axes principal_axes(const Shape& shape);

// The body turned about an axis of its mesh through `middle_m`, mesh frame.
Setting turned_about(const Setting& setting, std::size_t body, Vec3 middle_m, Vec3 axis, double angle_rad);

struct Turned {
  Setting setting;
  Vec3 axis;  // mesh frame
  double angle_rad = 0;
};
// The body turned about its principal axes by halves, thirds, ..., and by an odd angle: those whose rims are not far
// from what was seen, by a rough comparison. Refine before believing.
std::vector<Turned> turned_alike(const Fitted& fitted, const Question& question, std::size_t body);

// Directions of the body's numbers whose standard deviation moves its surface by more than `share` of its radius, in
// words.
std::vector<std::string> open_directions(const Fitted& fitted, const Question& question, std::size_t body,
                                         double share);

}  // namespace gonio::alignment
