// A mesh that deforms, somewhere on its way through its shapes: the one place that says what the manifest's "shapes" of
// meshes and images mean.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "io/ply.h"
#include "manifest/sections/forward.h"

namespace gonio::scene {

// The file of `meshes.at(id)`, its vertices where they are at `share` (0 to 1) of the way through its shapes: n shapes
// stand at 0, 1 / (n - 1), ..., 1, and between two of them every vertex goes straight. Without shapes: as it is in its
// file. What else the vertices bear (`wish`) is the file's; normals are not, once it is deformed. Error(data) where a
// shape has other vertices; `on_file` (or none) hears of every file that is read.
io::TriangleMesh deformed_mesh(const manifest::Document& document, const std::string& id, double share,
                               const io::PlyWish& wish = {},
                               const std::function<void(const std::filesystem::path&)>& on_file = {});

// How far object `id` is through its mesh's shapes in image `image`; where that is empty, in all images, which have to
// agree. 0 where nothing is said. Error(data) where they do not, or for what is no share.
double deformation_of(const manifest::Document& document, const std::string& id, const std::string& image);

}  // namespace gonio::scene
