// Where a soft and a hard mesh are near each other, and the plane between them (the thesis, 2.E). World frame.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::reassembly::contact {

struct Near {
  std::vector<std::uint32_t> soft;    // vertices nearer than the limit to the other mesh's surface
  std::vector<std::uint32_t> corner;  // for each of these a vertex of the nearest hard triangle: the deepest along down
  std::optional<Vec3> down;           // of the plane's normals the one away from the hard mesh; nothing: no plane
};
// `given`: where down is known and no plane is asked for.
Near near_parts(const io::TriangleMesh& soft, const io::TriangleMesh& hard, double limit_m, std::optional<Vec3> given);

// Middle and diagonal of the box round a mesh.
struct Extent {
  Vec3 middle{};
  double diagonal = 0;
};
Extent extent_of(const io::TriangleMesh& mesh);

}  // namespace gonio::reassembly::contact
