// Solids in place, as distances need them: where they are in the world, and bounds of the distance of two that cost a
// hundredth of the distance itself.
#pragma once
#include <vector>

#include "acquisition/laboratory/laboratory.h"

namespace gonio::acquisition {

struct Body {  // what does not change
  const Solid* solid = nullptr;
  int arm = -1;         // in the laboratory's order; -1: stands in the world
  Mat3 rotation;        // takes body coordinates to those of the frame it is fixed to
  Vec3 origin_m;        // likewise
  Vec3 middle_m;        // of the box that bounds it, body coordinates; of all but meshes zero
  Vec3 half_m;          // of that box
  double radius_m = 0;  // of the ball about the middle
  Vec3 core_m;          // half of a segment about the middle, body coordinates: the shape's backbone
};

struct PlacedBody {  // at a state, world coordinates
  Mat3 rotation;
  Vec3 origin_m, middle_m, core_m;
};

Body body_of(const Solid& solid, int arm);
// In the order: arms by name, each with its solids in order, then the obstacles. Keeps pointers to the solids.
std::vector<Body> bodies_of(const Laboratory& laboratory);
std::vector<PlacedBody> placed(const Laboratory& laboratory, const std::vector<Body>& bodies, const State& state);

// Never more than the distance of the two: of the balls about them, and across planes between them.
double ball_gap(const Body& a, const PlacedBody& at_a, const Body& b, const PlacedBody& at_b);
double plane_gap(const Body& a, const PlacedBody& at_a, const Body& b, const PlacedBody& at_b);

// For boxes, balls and cylinders: from points of either that are near to each other, the distance of the two and how
// far it may be too large at most. Alternating projections (Cheney & Goldstein 1959) bound it from above, planes from
// below.
struct Bounded {
  double distance_m = 0, too_large_m = 0;
};
Bounded bounded_distance(const Body& a, const PlacedBody& at_a, const Body& b, const PlacedBody& at_b, Vec3 on_b_m);

}  // namespace gonio::acquisition
