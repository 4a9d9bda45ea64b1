// The rim of a region in the plane that is covered by overlapping pieces: directed segments, to whose left it is
// covered `jump` times more often than to their right, are cut where they cross each other, and those parts remain to
// whose right nothing is covered. Outer rims and those of holes come alike, the region to their left.
//
// Instead of walking along the rim (thesis, contribution E, algorithm 1: one start for the outer rim, one for every
// hole) each part is asked by itself: how often is the place beside it covered? That number is the sum of the jumps
// along a straight line from far away, which is the winding number of the segments around it, since those of a mesh
// (shape.h) form closed curves. So holes need no start of their own, and a part that rounding spoils spoils no other.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::alignment {

struct Segment {
  Vec2 from, to;
  int jump = 0;
};
struct RimPiece {
  std::uint32_t segment = 0;
  double start = 0, end = 1;  // shares of the segment
  Vec2 from, to;
};

// Segments of length zero are left out. In the order of the segments; the same for any order of theirs but for that.
std::vector<RimPiece> rim_of(std::span<const Segment> segments);

// Of the region to the left of `pieces`, by Green's theorem: the integrals of x^p y^q over it, p + q <= 3, about
// `origin`, in the order 1, x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3. The area is positive for rims as rim_of() gives
// them, in axes in which they run to the left.
struct Moments {
  double m00 = 0, m10 = 0, m01 = 0, m20 = 0, m11 = 0, m02 = 0, m30 = 0, m21 = 0, m12 = 0, m03 = 0;
};
Moments moments_of(std::span<const RimPiece> pieces, Vec2 origin);

}  // namespace gonio::alignment
