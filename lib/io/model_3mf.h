// 3MF models (3MF Consortium, Core Specification 1.3): what the build places, as one mesh. Supports, materials, colours
// and extensions are passed over.
#pragma once
#include <filesystem>
#include <string>

#include "io/ply.h"

namespace gonio::io {

// Lengths in metres: the format states its unit. Items of the build with their transforms, components within; without a
// build every object of type model. Objects that a transform mirrors keep facing outwards. Error(no_input), Error(data)
// for what is no such archive, numbers that are none, triangles and components that lead nowhere or to themselves.
TriangleMesh read_3mf(const std::filesystem::path& path);
// The model's own XML; `place` names it in errors.
TriangleMesh parse_3mf_model(std::string_view xml, const std::string& place);

}  // namespace gonio::io
