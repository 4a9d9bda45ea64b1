// Built-in scenes: an object that the project makes itself on a table, three virtual cameras, three lamps, and the
// noise of a virtual sensor. Metres; world z up. They need no data and show every part of the chain.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"

namespace gonio::render {

struct Specimen {
  std::string name, sentence;
};
const std::vector<Specimen>& specimens();

// The scene as a manifest: diffuse surfaces whose albedos are free, point lights that share one free intensity, a
// pinhole camera, and nine images, every camera under every lamp. Meshes are written into `out`. Error(usage) for
// unknown names.
manifest::Document specimen(const std::string& name, const std::filesystem::path& out);

}  // namespace gonio::render
