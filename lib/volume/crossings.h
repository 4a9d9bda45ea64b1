// Triangles of a surface that pass through one another.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geom/vector.h"

namespace gonio::volume {

// Pairs of triangles of which one has an edge through the inside of the other, or which lie folded over an edge that
// they share; only pairs in which a vertex of `stirred` takes part. Triangles of some voxels' size: pairs are looked for
// in a grid of cells of two voxels. In double precision without exact predicates: touching counts as crossing where it
// cannot be told from it.
std::vector<std::array<std::uint32_t, 2>> crossing_triangles(
    const std::vector<Vec3>& places, const std::vector<std::array<std::uint32_t, 3>>& triangles,
    const std::vector<bool>& stirred);

}  // namespace gonio::volume
