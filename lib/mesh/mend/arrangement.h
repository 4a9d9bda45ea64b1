// Triangles cut along where they meet others, in exact numbers.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "io/ply.h"
#include "mesh/adjacency.h"

namespace gonio::mesh {

struct Arrangement {
  std::vector<Vec3> positions_m{};      // no two of them at one exact place
  std::vector<Corners> triangles{};     // that meet in whole edges and corners alone, or lie on each other
  std::vector<std::uint32_t> parent{};  // of each: the triangle that it is or was cut from
  // Of each: triangles before that lie in its plane and cover it, its parent among them, ascending; empty: it alone.
  std::vector<std::vector<std::uint32_t>> covering{};
  std::size_t crossings = 0, cut = 0;  // pairs that met; triangles that were cut
  bool complete = true;                // false, and nothing else: more than 4 million pairs meet
  struct Exactly;
  std::shared_ptr<Exactly> exactly{};  // the positions
};
Arrangement arrange(const io::TriangleMesh& mesh);

// How often the mesh that was arranged goes round the places just before and just behind the middle of a triangle of
// the arrangement: exact, by the triangles that a ray from there passes. Not from two threads at once.
std::array<int, 2> windings(const io::TriangleMesh& mesh, const Arrangement& arrangement, std::uint32_t triangle);

}  // namespace gonio::mesh
