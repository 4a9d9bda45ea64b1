// Contact: a hard piece was set down on something soft (a cloth, a cushion), which was scanned before it gave way, or
// the pose is off by a little; now the two meshes intersect. The soft one gives way. World frame, metres.
//
// Vertices move along one direction, "down", by u. Then what lies over what stays as it is, and all demands are linear
// inequalities in u (contact_overlay.h): no vertex, edge or face of the soft mesh stays in the hard one, and layers of
// a folded cloth press on each other and never change places.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::reassembly {

enum class Yield {
  // The thesis (2.E): soft vertices nearer to the hard mesh than `near` of its box's diagonal are contact vertices; the
  // plane through them (robust least squares) gives "down"; each is pushed below the lowest corner of the hard triangle
  // nearest to it. Where that leaves edges or faces in the hard body, their corners are pushed on.
  push,
  // The least smooth deformation that removes all intersections: u minimises the thin-plate energy (bilaplacian of the
  // mesh, cotangent weights) under the inequalities; vertices farther than `reach_m` from any face that had to give way
  // stay where they are, exactly, as if the sheet were clamped there.
  elastic
};
struct ContactWish {
  Yield yield = Yield::push;
  double near = 0.07;          // share of the hard mesh's box diagonal
  double clearance_m = 1e-6;   // left between the two
  double reach_m = 0;          // 0: `near` times the diagonal
  double deepest_m = 0;        // a push deeper than this is refused (0: `near` times the diagonal)
  std::optional<Vec3> down{};  // where it is known (gravity); else the contact plane's
};
struct Contact {
  io::TriangleMesh soft;                          // after it gave way; same triangles, same vertices
  std::vector<std::uint32_t> moved;               // its vertices that moved
  Vec3 down;                                      // unit
  double deepest_m = 0, mean_m = 0;               // over what moved
  double volume_m3 = 0;                           // swept by the soft surface, each layer for itself
  std::size_t pairs_before = 0, pairs_after = 0;  // of intersecting triangles, one of each mesh
  std::size_t inside_before = 0;                  // soft vertices inside the hard body
  std::size_t self_before = 0, self_after = 0;    // pairs of the soft mesh's own, among the faces that moved
  std::string refused;                            // why nothing was moved; empty: done
};
// `hard` is closed and faces outwards; Error(data) at `place` otherwise. After success pairs_after is 0, checked with
// exact predicates, and no soft vertex is inside. Where they do not meet, nothing moves.
Contact give_way(const io::TriangleMesh& soft, const io::TriangleMesh& hard, const ContactWish& wish,
                 const std::string& place);

}  // namespace gonio::reassembly
