// STL triangle meshes, ascii and binary: what robot makers ship as collision models. Lengths are the file's own: the
// format has no unit. Corners at the same place become one vertex; normals of the file are not kept, for many writers
// leave them at zero.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "io/ply.h"

namespace gonio::io {

// A binary file's count is checked against its length before anything is allocated; a binary file may begin with
// "solid", as many do. NaN, truncation and words out of place are Error(data) that names the triangle.
TriangleMesh read_stl(const std::filesystem::path& path);
// A whole file; `place` names it in errors.
TriangleMesh parse_stl(std::string_view file, const std::string& place);

}  // namespace gonio::io
