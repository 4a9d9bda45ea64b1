// Which displacements along "down" keep a soft mesh below a hard one, and its layers in their order. Local frame: x and
// y across, z the depth along down.
//
// Vertices move along z alone, so that what lies over what in the (x, y) plane stays as it is. Over each piece of the
// overlay of two triangulations both heights are linear; their difference has its extremes at the overlay's vertices: a
// vertex of one in a face of the other, or two edges that cross. One linear inequality at each of these is therefore
// necessary and sufficient, for edges and faces as well as for vertices.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::reassembly::contact {

using Faces = std::vector<std::array<std::uint32_t, 3>>;
using Edge = std::array<std::uint32_t, 2>;

struct Layered {
  std::vector<Vec3> at;
  Faces faces;
};

// sum of weight * u(vertex) >= bound, u the displacements along z.
struct Row {
  std::array<std::uint32_t, 6> vertex{};
  std::array<double, 6> weight{};
  std::uint32_t count = 0;
  double bound = 0;
  Vec2 slope;  // of the plane in which the two would touch there: dz/dx, dz/dy
  void add(std::uint32_t v, double w);
  double short_by(std::span<const double> u) const;  // bound - sum, positive where it is broken
  Vec3 where(const std::vector<Vec3>& at) const;     // on the soft mesh; of rows_below only
};

// What a line down from a point meets of a closed mesh.
struct Column {
  bool inside = false;
  double exit = 0;  // how far below the point the line leaves the mesh last, within the window; 0: nowhere
};
std::vector<Column> columns(const std::vector<Vec3>& points, const Layered& hard, double window);

struct Below {
  double window = 0, clearance = 0;
  std::vector<std::uint8_t> free;     // per soft vertex: may move
  std::vector<std::uint8_t> captive;  // per soft vertex: has to go below what is under it
  std::vector<std::uint8_t> gripped;  // per soft face: meets the hard mesh, or has a captive corner
};
std::vector<Row> rows_below(const Layered& soft, const Layered& hard, const Below& wish);

// Layers of the soft mesh that lie over each other nearer than `window` keep their order, with the clearance or half of
// the gap that they had, whichever is less.
std::vector<Row> rows_between_layers(const Layered& soft, const std::vector<std::uint8_t>& free, double window,
                                     double clearance);

// What has to give way: vertices inside, or on faces that meet the hard mesh, and what hangs on these over the hard
// mesh's underside (a sheet through the floor of a bowl lies in the bowl, inside of nothing).
struct Grip {
  std::vector<std::uint8_t> captive;  // per soft vertex
  std::vector<std::uint8_t> gripped;  // per soft face: meets the hard mesh, or has a captive corner
  std::size_t inside = 0;
  std::vector<std::uint32_t> stuck;  // inside, without a way out within the window
};
Grip grip_of(const Layered& soft, const Layered& hard, std::span<const std::uint32_t> meeting_faces, double window);

std::vector<Edge> edges_of(const Faces& faces);  // each once, the smaller number first, ascending

}  // namespace gonio::reassembly::contact
