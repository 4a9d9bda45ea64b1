// Solids as the manifest gives them.
#pragma once
#include <filesystem>
#include <string>

#include "acquisition/laboratory/solid.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

// Shape, name and triangles; `pointer` is the body's place in the document. Error(data) unless it is exactly one shape,
// for sizes that are none and for a file that is neither PLY nor STL.
Solid solid_of(const manifest::Document& document, const manifest::SolidBody& body, const std::string& pointer);

// The triangles of a PLY or STL file.
void put_mesh(const std::filesystem::path& path, Solid& solid);

}  // namespace gonio::acquisition
