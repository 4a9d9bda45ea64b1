// Pieces of one object that stand on each other, a lid on its pot: does the upper one, placed by its own markers, float
// over its seat or sink into it, and where would it come to rest? World frame, metres, radians.
//
// Over the overlay of the upper piece's underside and the lower one's upper side (contact_overlay.h) the gap along down
// has its extremes at the overlay's vertices; to first order each changes with the upper piece's small motion (w, v)
// about c by m.(v + w x (p - c)), m the touching plane's normal with m.up = 1. At rest the centre of mass is as low as
// these gaps allow by sinking and tilting: a linear programme in three unknowns, whose three active gaps are the feet.
// Shifts across and the turn about down follow by their covariance with these (friction holds what nothing pushes), and
// are nudged by as little as frees the sides of plug and neck: the smallest motion, in the sense of the covariances,
// that ends at rest. Not seen: undercuts, of which the upper piece's underside lies rightly below the lower one's upper
// side in one column. Rest is what is reached by sinking: a plug that its pose tilts against the neck may stay there,
// as a real one does (4 of 2000 drawn lids with half a millimetre of play).
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "io/ply.h"

namespace gonio::reassembly {

struct StandingPiece {
  std::string object;
  const io::TriangleMesh* mesh = nullptr;  // closed, object frame
  Rigid<frame::World, frame::Object> world_from_object;
  // Of a small motion (rotation vector, place) in the world at `at_m`, as place.h gives them.
  std::array<double, 36> covariance{};
  Vec3 at_m;
};

enum class Standing { touches, floats, sinks, apart };  // apart: nothing of the lower piece is under it within reach
struct Seat {
  Standing standing = Standing::apart;
  double gap_m = 0;    // the smallest along down; negative: the deepest penetration
  double sigma_m = 0;  // of it, by both covariances
  Vec3 where_m;        // on the lower piece
};
struct SettleWish {
  double most_sigma = 3;      // farther from where the markers put it, it is not moved
  double reach_m = 0;         // gaps and penetrations up to this are seen; 0: 7 % of the upper piece's box diagonal
  double clearance_m = 1e-6;  // left between the two
};
struct Settled {
  Seat before;
  Rigid<frame::World, frame::Object> world_from_object;  // of the upper piece; as it was where refused
  Vec3 turn_rad, shift_m;    // what was done: a turn about the centre of mass, then its shift
  double sigmas = 0;         // the motion's Mahalanobis distance
  std::vector<Vec3> feet_m;  // where it stands
  std::string refused;       // why it was not moved; empty: it stands
};
// More than `most_sigma` of these standard deviations off zero, it floats or sinks. Where sides meet, after the
// smallest shift across that frees them.
Seat seat_of(const StandingPiece& upper, const StandingPiece& lower, Vec3 down, const SettleWish& wish = {});
// Error(data) at `place` where a mesh is not closed. After success no triangles of the two meet (exact predicates). A
// piece that its markers place truly is refused with 2.9 % (three degrees beyond 3 sigma).
Settled settle(const StandingPiece& upper, const StandingPiece& lower, Vec3 down, const SettleWish& wish,
               const std::string& place);

}  // namespace gonio::reassembly
