// Solids as triangles, to be drawn.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "acquisition/laboratory/solid.h"

namespace gonio::acquisition {

struct SolidMesh {
  std::vector<Vec3> vertices_m;  // in the solid's own frame
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
SolidMesh mesh_of(const Solid& solid);  // of round ones 24 facets to a turn

}  // namespace gonio::acquisition
