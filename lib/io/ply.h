// PLY triangle meshes: ascii, binary little and big endian; float or double coordinates kept in double.
//
// Further properties of the vertices are kept where the caller asks for them, in single precision. Those of type uchar
// are shares of 255; red, green and blue of that type are sRGB codes and become linear.
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
  std::vector<std::vector<float>> properties;           // in the order of PlyWish::properties; empty: not in the file
  std::vector<std::int32_t> labels;                     // per triangle, the property `label` of its face, or empty
};

// What to keep beside positions, normals and texture coordinates.
struct PlyWish {
  std::vector<std::string> properties;  // of the vertices, by name
  bool labels = false;
};

// Polygons are fanned into triangles. The header's counts are checked against the file's length before anything is
// allocated; indices, NaN and truncation are Error(data) naming the element and its number.
TriangleMesh read_ply(const std::filesystem::path& path, const PlyWish& wish = {});
// A whole file; `place` names it in errors.
TriangleMesh parse_ply(std::string_view file, const std::string& place, const PlyWish& wish = {});
// Binary little endian, double coordinates; properties under the names that `wish` gave them.
void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh, const PlyWish& wish = {});

}  // namespace gonio::io
