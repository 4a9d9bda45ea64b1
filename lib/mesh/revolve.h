// Surfaces of revolution about z, closed at the axis.
#pragma once
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

struct ProfilePoint {
  double r, z;  // m
  Vec2 normal;  // (r, z), unit, outwards
};

// `profile`: anticlockwise in the half plane with r to the right and z up, so that the surface looks outwards; its
// first point lies beside the axis below, its last one where the profile comes back to it. A vertex on the axis closes
// each end, at its neighbour's height, with the normal -z at the first and +z at the last. Clockwise: a cavity, once
// turned inside out by the caller. Vertices of a point stand together, `sectors` of them.
io::TriangleMesh revolved(const std::vector<ProfilePoint>& profile, int sectors);

// Normals of a profile that is given by places alone, by differences of neighbours.
std::vector<ProfilePoint> profile_through(const std::vector<Vec2>& places);

}  // namespace gonio::mesh
