// The ready phantoms of phantom.h. Nothing lies along an axis of the volume or exactly at its centre, where voxels
// would sample all of a surface alike.
#include <algorithm>
#include <cmath>

#include "ct/phantom.h"
#include "ct/profile.h"

namespace gonio::ct {
namespace {

Mat3 askew(double degrees, Vec3 axis = {0.8, 0.6, 0}) {
  return rotation_about(axis, degrees * pi / 180);
}
Vec3 off_centre(const Place& place) {
  return Vec3{0.31, -0.23, 0.17} * place.voxel_m;
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
  const ShapePtr pot = teapot_body(e, wall);

  Phantom phantom{"teapot", {{"pot", turned(pot, turn, shift), glass()}}, {}};
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
