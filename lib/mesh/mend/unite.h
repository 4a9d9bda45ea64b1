// The union of what closed surfaces enclose: where they go round a place more often outwards than inwards.
#pragma once
#include <cstddef>
#include <cstdint>

#include "io/ply.h"

namespace gonio::mesh {

struct United {
  std::size_t crossings = 0;      // pairs of triangles that met
  std::size_t cut_triangles = 0;  // that were cut along where they met
  std::size_t within = 0;         // pieces that lay wholly inside of others, and went
  bool given_up = false;          // more than 4 million pairs meet: the mesh is as it was
};
// Every edge of the mesh is passed as often forwards as backwards, and stays so. Triangles that meet are cut along
// their intersections (exact numbers, CGAL), coincident ones alike; of the parts those stay that have a winding number
// above 0 on one side alone, facing outwards (Zhou, Grinspun, Zorin & Jacobson 2016, Mesh arrangements for solid
// geometry).
United unite(io::TriangleMesh& mesh);

}  // namespace gonio::mesh
