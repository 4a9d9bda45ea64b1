// Poisson-disk resampling of points: a subset no two of which are nearer than one distance, as large as asked for.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/reconstruct/point_tree.h"

namespace gonio::mesh {

// Dart throwing over the points in a random order that the seed fixes (Corsini, Cignoni & Scopigno 2012, on points
// instead of a mesh); the distance is found so that about `count` (within 2 %) stay. All points where there are no
// more. Ascending.
std::vector<std::uint32_t> poisson_disk(const PointTree& tree, std::size_t count, std::uint64_t seed);

}  // namespace gonio::mesh
