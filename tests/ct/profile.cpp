// Outlines of glassware: ct/profile.h.
#include "ct/profile.h"

#include <algorithm>
#include <cmath>

namespace gonio::ct {
namespace {

constexpr int arc_steps = 64;  // of a curve: its chords miss it by 1e-4 of its radius at most

}  // namespace

std::vector<Vec2> arc(double a, double b, double z, double from, double to, double offset) {
  std::vector<Vec2> points;
  for (int k = 0; k <= arc_steps; ++k) {
    const double t = from + (to - from) * k / arc_steps;
    const Vec2 n{std::cos(t) / a, std::sin(t) / b};
    points.push_back(
        {std::max(0.0, a * std::cos(t) + offset * n.x / norm(n)), z + b * std::sin(t) + offset * n.y / norm(n)});
  }
  return points;
}

std::vector<Vec2> wall_of(double a, double b, double z, double from, double to, double thickness) {
  std::vector<Vec2> outer = arc(a, b, z, from, to, 0), inner = arc(a, b, z, from, to, -thickness);
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  return outer;
}

std::vector<Vec2> ring_profile(double ring, double tube) {
  std::vector<Vec2> points;
  for (int k = 0; k < 48; ++k)
    points.push_back({ring + tube * std::cos(2 * pi * k / 48), tube * std::sin(2 * pi * k / 48)});
  return points;
}

TeapotSizes teapot_sizes(double extent) {
  return {0.27 * extent, 0.23 * extent, 0.11 * extent};
}

ShapePtr teapot_body(double extent, double wall) {
  const double e = extent;
  const auto [a, b, open] = teapot_sizes(e);
  const ShapePtr body = ellipsoid({}, {a, a, b}), inside = ellipsoid({}, {a - wall, a - wall, b - wall});
  // The spout rises by 50 degrees from the body's side.
  const auto spout = [&](double foot, double tip, double from, double to) {
    const ShapePtr cone = lathe({}, {{0, from}, {foot, from}, {tip, to}, {0, to}});
    return turned(cone, rotation_about({0, 1, 0}, 50 * pi / 180), {0.17 * e, 0, -0.04 * e});
  };
  const double length = 0.27 * e, foot = std::max(0.055 * e, 2.2 * wall), tip = std::max(0.035 * e, 1.8 * wall);
  const double narrower = (tip - foot) / length;
  const ShapePtr outside = spout(foot, tip, 0, length);
  const ShapePtr bore = spout(foot - wall, tip - wall + 2 * wall * narrower, 0, length + 2 * wall);
  const ShapePtr handle =
      turned(lathe({}, ring_profile(0.11 * e, 0.022 * e)), rotation_about({1, 0, 0}, pi / 2), {-0.29 * e, 0, 0.01 * e});
  const ShapePtr opening = cylinder({0, 0, 0}, {0, 0, 1.3 * b}, open);
  return without(united({body, outside, handle}), united({inside, bore, opening}));
}

}  // namespace gonio::ct
