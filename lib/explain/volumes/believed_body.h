// The believed shape as shares of cells: what of each cell of a grid lies within a closed mesh.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "mesh/mesh.h"

namespace gonio::explain::volumes {

struct Body {
  std::array<std::size_t, 3> size{};
  Vec3 cell_m{}, first_m{};         // first: centre of cell (0, 0, 0), in the scanner's frame
  std::vector<float> share;         // i fastest
  double at(Vec3 scanner_m) const;  // linear between centres, 0 outside of the grid
};

// `size` cells that fill the box of the given full extent about the origin. Error(data) at `place` where the mesh is
// open or faces inwards.
Body body_of(const mesh::Mesh& mesh, std::array<std::size_t, 3> size, Vec3 extent_m, const std::string& place);

}  // namespace gonio::explain::volumes
