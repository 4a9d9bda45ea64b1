// What decides where rims lie: bodies, cameras, lamps and the ground, and by which numbers a fit moves them.
//
// World frame, metres. Pixels are those of the camera without its distortion: positions that were observed are
// straightened (observation.h), so that straight edges have straight pictures here.
//
// A body's mesh is scaled along its own axes about the middle of its box, then moved:
//   P = world_from_object * (c + diag(scale) (x - c)).
// A lamp at L throws the shadow of P onto the ground n . y = e at
//   S = (a P - b L) / (a - b),  a = n . L - e,  b = n . P - e     (Blinn, Me and my (fake) shadow, 1988).
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "alignment/shape.h"
#include "geom/rigid.h"

namespace gonio::alignment {

struct Body {
  const Shape* shape = nullptr;
  Rigid<frame::World, frame::Object> world_from_object{};
  Vec3 scale{1, 1, 1};
  Vec3 centre_m() const { return world_from_object * shape->centre_m(); }
  Vec3 place_m(Vec3 mesh_point) const {
    const Vec3 c = shape->centre_m();
    return world_from_object * (c + scale * (mesh_point - c));
  }
};
struct Lens {  // of a camera: pixels
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};
struct Station {  // where a camera stands for one or several photographs
  Rigid<frame::World, frame::Camera> world_from_camera{};
  std::size_t lens = 0;
};
struct Ground {
  Vec3 normal{0, 0, 1};  // unit, upwards
  double offset_m = 0;   // normal . y = offset_m
  double height_m(Vec3 point) const { return dot(normal, point) - offset_m; }
};
struct Setting {
  std::vector<Body> bodies;
  std::vector<Lens> lenses;
  std::vector<Station> stations;
  std::vector<Vec3> lamps_m;
  std::optional<Ground> ground;
};

// Groups of numbers that a fit moves. A change of `turn` is a rotation vector in the world: of a body about its centre,
// of a station about its camera's centre, of the ground (two components, along its own axes) about `pivot`.
enum class Block {
  body_turn,
  body_shift,
  body_scale,
  station_turn,
  station_shift,
  lens_focal,
  lamp_shift,
  ground_tilt,
  ground_shift
};
constexpr std::size_t width_of(Block block) {
  return block == Block::lens_focal || block == Block::ground_shift ? 1 : block == Block::ground_tilt ? 2 : 3;
}
struct Freedom {  // one block of one body, station, ... that is free
  Block block{};
  std::size_t which = 0;
  double prior_sigma = 0;  // rad, m, or (scale, focal) of the logarithm: of the stated values; 0: nothing is known
  bool uniform = false;    // body_scale: one factor for all axes
  std::size_t size() const { return uniform ? 1 : width_of(block); }
};

// `change` holds the numbers of all freedoms, one block after the other. Scales and focal lengths change by factors
// exp(change).
Setting moved(const Setting& setting, const std::vector<Freedom>& freedoms, const std::vector<double>& change);
// Numbers that take `from` to `to`: what moved() would have to be given, to first order in rotations.
std::vector<double> change_between(const Setting& from, const Setting& to, const std::vector<Freedom>& freedoms);
std::size_t numbers_of(const std::vector<Freedom>& freedoms);

// The ground's tangents, in which its tilt is counted, and the point about which it tilts: beneath the first body.
struct GroundAxes {
  Vec3 t, b, pivot_m;
};
GroundAxes ground_axes(const Setting& setting);
// A pose on the ground `from` once that is `to`: turned the shortest way about `pivot_m`, its origin on the ground.
Rigid<frame::World, frame::Object> carried_along(const Rigid<frame::World, frame::Object>& pose, const Ground& from,
                                                 const Ground& to, Vec3 pivot_m);

// How one place in the picture moves with a world point, and that with the numbers: rows of d(pixel . normal).
// A rim's place in a picture.
struct Projected {
  Vec2 pixel;
  double weight =
      0;  // homogeneous: what the pixel's coordinates were divided by; not positive: behind the camera, or no shadow
};
Projected project(const Setting& setting, std::size_t station, Vec3 world);
// Of the shadow that `lamp` throws.
Projected project_shadow(const Setting& setting, std::size_t station, std::size_t lamp, Vec3 world);

// d(normal . pixel) by all numbers, for the picture of the mesh point `mesh_point` of `body` (of its shadow, where
// `lamp` is given): written to `row`, which has numbers_of(freedoms) places.
void slopes_of(const Setting& setting, const std::vector<Freedom>& freedoms, const GroundAxes& axes,
               std::size_t station, std::size_t body, std::optional<std::size_t> lamp, Vec3 mesh_point, Vec2 normal,
               double* row);
// Height over the ground of a mesh point, and its slopes.
double height_of(const Setting& setting, std::size_t body, Vec3 mesh_point);
void height_slopes(const Setting& setting, const std::vector<Freedom>& freedoms, const GroundAxes& axes,
                   std::size_t body, Vec3 mesh_point, double* row);

}  // namespace gonio::alignment
