// The domains that a manifest offers to explain: board corners in tables, images of a scene, hand-eye sets.
// Each becomes one problem.
#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "explain/problem.h"

namespace gonio::explain {

// One problem for each domain of the manifest, boards first. Error(data) where there is none.
std::vector<std::unique_ptr<Problem>> problems_of(const manifest::Document& document);

// Files of the manifest that these problems read: pictures, masks, meshes, tables, calibrations of robots.
std::vector<std::filesystem::path> files_of(const manifest::Document& document);

}  // namespace gonio::explain
