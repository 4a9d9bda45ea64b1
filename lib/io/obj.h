// Wavefront OBJ: places and faces (Wavefront Technologies, Advanced Visualizer, appendix B1). Lengths are the file's
// own: the format has no unit. Normals, texture, groups, materials, lines and free-form surfaces are passed over.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "io/ply.h"

namespace gonio::io {

// Polygons are fanned into triangles from their first corner, so that concave ones have parts that fold back on
// themselves: areas and volumes with their signs are right. Numbers of places that lead nowhere, of none, faces of
// fewer than three corners and numbers that are not finite are Error(data) that names the line.
TriangleMesh read_obj(const std::filesystem::path& path);
// A whole file; `place` names it in errors.
TriangleMesh parse_obj(std::string_view file, const std::string& place);

// STL, PLY, OBJ or 3MF, by the name's ending, else by the file's beginning. Lengths as the file has them, but 3MF's in
// metres: `in_metres` (may be null) receives which.
TriangleMesh read_mesh(const std::filesystem::path& path, bool* in_metres = nullptr);

}  // namespace gonio::io
