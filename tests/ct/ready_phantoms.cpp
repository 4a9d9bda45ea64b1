// The ready phantoms of phantom.h. Nothing lies along an axis of the volume or exactly at its centre, where voxels
// would sample all of a surface alike.
#include <algorithm>
#include <cmath>

#include "ct/phantom.h"

namespace gonio::ct {
namespace {

constexpr int arc_steps = 64;  // of a curve: its chords miss it by 1e-4 of its radius at most

Mat3 askew(double degrees, Vec3 axis = {0.8, 0.6, 0}) {
  return rotation_about(axis, degrees * pi / 180);
}
Vec3 off_centre(const Place& place) {
  return Vec3{0.31, -0.23, 0.17} * place.voxel_m;
}

// Points of an ellipse of half-axes (a, b) about (0, z), at angles from `from` to `to`, moved outwards by `offset`.
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

// A wall of even thickness inside of an arc.
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

}  // namespace

Phantom glass_block(const Place& place) {
  const double e = place.extent();
  const Vec3 along = askew(3) * Vec3{0, 0, 0.3 * e}, at = off_centre(place);
  return {"glass block", {{"block", cylinder(at - along, at + along, 0.36 * e), glass()}}, {}};
}

Phantom glass_tube(const Place& place, double wall_voxels) {
  const double e = place.extent(), outer = 0.3 * e;
  const Vec3 along = askew(7) * Vec3{0, 0, 0.36 * e}, at = off_centre(place);
  ShapePtr tube = without(cylinder(at - along, at + along, outer),
                          cylinder(at - along * 1.2, at + along * 1.2, outer - wall_voxels * place.voxel_m));
  return {"glass tube", {{"tube", std::move(tube), glass()}}, {}};
}

Phantom hollow_sphere(const Place& place, double wall_voxels) {
  const double outer = 0.38 * place.extent();
  const Vec3 at = off_centre(place);
  ShapePtr shell = without(ball(at, outer), ball(at, outer - wall_voxels * place.voxel_m));
  return {"hollow sphere", {{"sphere", std::move(shell), glass()}}, {}};
}

Phantom bowl_with_lid(const Place& place, double wall_voxels) {
  const double e = place.extent(), wall = wall_voxels * place.voxel_m, radius = 0.36 * e, rim = 0.05 * e;
  const ShapePtr bowl = lathe({}, wall_of(radius, radius, 0, -pi / 2, 0.06, wall));
  // The lid's cap sinks into the rim by a voxel and a half: one piece of glass round one hollow.
  const ShapePtr lid = lathe({0, 0, rim / 4}, wall_of(radius, 0.22 * e, -1.5 * place.voxel_m, 0.02, pi / 2, wall));
  const ShapePtr knob = ball({0, 0, 0.22 * e + 0.045 * e}, 0.05 * e);
  const ShapePtr foot = lathe({}, {{0.12 * e, -radius - 0.03 * e},
                                   {0.16 * e, -radius - 0.03 * e},
                                   {0.16 * e, -0.85 * radius},
                                   {0.12 * e, -0.88 * radius}});
  const ShapePtr hollow = ball({}, radius - wall);  // the foot does not reach into it
  ShapePtr glassware = united({bowl, lid, knob, without(foot, hollow)});
  return {"bowl with lid", {{"bowl", turned(std::move(glassware), askew(5), off_centre(place)), glass()}}, {}};
}

Phantom teapot(const Place& place, double wall_voxels, double marker_voxels, const Material& marker_material) {
  const double e = place.extent(), wall = wall_voxels * place.voxel_m, a = 0.27 * e, b = 0.23 * e;
  const double marker = (marker_voxels > 0 ? marker_voxels : 0.045 * static_cast<double>(place.voxels)) * place.voxel_m;
  const Mat3 turn = askew(6);
  const Vec3 shift = off_centre(place);
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
  const ShapePtr opening = cylinder({0, 0, 0}, {0, 0, 1.3 * b}, 0.11 * e);
  ShapePtr pot = without(united({body, outside, handle}), united({inside, bore, opening}));

  Phantom phantom{"teapot", {{"pot", turned(std::move(pot), turn, shift), glass()}}, {}};
  std::vector<ShapePtr> balls;
  // Longitude and parametric latitude in degrees: clear of spout (0) and handle (180), no two alike.
  for (const auto& [longitude, latitude] : {std::pair{41.0, 14.0},
                                            {77.0, -31.0},
                                            {98.0, 33.0},
                                            {126.0, -9.0},
                                            {222.0, 24.0},
                                            {247.0, -36.0},
                                            {269.0, 3.0},
                                            {301.0, 38.0},
                                            {318.0, -22.0}}) {
    const double l = longitude * pi / 180, t = latitude * pi / 180;
    const Vec3 at{a * std::cos(t) * std::cos(l), a * std::cos(t) * std::sin(l), b * std::sin(t)};
    const Vec3 n = normalized({at.x / (a * a), at.y / (a * a), at.z / (b * b)});
    const Ball sphere{turn * (at + n * (0.88 * marker)) + shift, marker};  // sunk into the glue by 12 % of its radius
    phantom.markers.push_back(sphere);
    balls.push_back(ball(sphere.centre, sphere.radius));
  }
  phantom.parts.push_back({"markers", united(std::move(balls)), marker_material});
  return phantom;
}

Phantom step_block(const Place& place) {
  const double e = place.extent();
  const ShapePtr block = box({}, {0.27 * e, 0.2 * e, 0.31 * e});
  const ShapePtr step = box({0.2 * e, 0, 0.25 * e}, {0.13 * e, 0.3 * e, 0.15 * e});
  const ShapePtr bore = cylinder({-0.12 * e, -e, 0.03 * e}, {-0.12 * e, e, 0.03 * e}, 0.07 * e);
  const Mat3 turn = rotation_about(normalized({0.36, 0.48, 0.8}), 0.37);
  ShapePtr solid = turned(without(without(block, step), bore), turn, off_centre(place));
  return {"step block", {{"block", std::move(solid), aluminium()}}, {}};
}

}  // namespace gonio::ct
