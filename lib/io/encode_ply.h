// A PLY file's bytes, for those who keep files by their content.
#pragma once
#include <string>

#include "io/ply.h"

namespace gonio::io {

// What write_ply() writes.
std::string encode_ply(const TriangleMesh& mesh, const PlyWish& wish = {});

}  // namespace gonio::io
