// Holes of a mesh that make_surfaces() has seen, so that every rim is one loop.
#pragma once
#include <cstdint>
#include <vector>

#include "io/ply.h"

namespace gonio::mesh {

struct HoleRim {
  std::vector<std::uint32_t> loop;  // vertices, in the sense in which the triangles that close it pass them
  std::uint32_t piece = 0;          // of Surfaces
  double diagonal_m = 0;            // of the box about it
};
std::vector<HoleRim> rims_of(const io::TriangleMesh& mesh, const std::vector<std::uint32_t>& piece);

// Triangles between the loop's vertices: of all such triangulations that whose sharpest fold, against the surface
// beside it, too, is bluntest, and of those the smallest (Liepa 2003, Filling holes in meshes; Barequet & Sharir 1995).
// In front of planes and at corners that is what was there. The time goes with the cube of the loop's length, at most
// `longest_rim`.
constexpr std::size_t longest_rim = 400;
std::vector<std::array<std::uint32_t, 3>> closing_triangles(const io::TriangleMesh& mesh,
                                                            const std::vector<std::uint32_t>& loop);

}  // namespace gonio::mesh
