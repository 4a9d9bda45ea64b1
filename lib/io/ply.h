// PLY triangle meshes: ascii, binary little and big endian; float or double coordinates kept in double.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "geom/vector.h"

namespace gonio::io {

struct TriangleMesh {
  std::vector<Vec3> positions_m;                        // object frame
  std::vector<Vec3> normals;                            // per vertex, empty where the file has none
  std::vector<Vec2> texture;                            // per vertex (s,t / u,v / texture_u,texture_v), or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
};

// Polygons are fanned into triangles. The header's counts are checked against the file's length before anything is
// allocated; indices, NaN and truncation are Error(data) naming the element and its number.
TriangleMesh read_ply(const std::filesystem::path& path);
TriangleMesh parse_ply(std::string_view file, const std::string& place);  // a whole file; `place` names it in errors
void write_ply(const std::filesystem::path& path,
               const TriangleMesh& mesh);  // binary little endian, double coordinates

}  // namespace gonio::io
