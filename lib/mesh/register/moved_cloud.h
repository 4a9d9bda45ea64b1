// A cloud's file with its points moved and their normals and covariances turned; every other property stays.
#pragma once
#include <filesystem>

#include "mesh/register.h"

namespace gonio::mesh {

void write_moved_cloud(const std::filesystem::path& from, const ViewMotion& motion, const std::filesystem::path& to);

}  // namespace gonio::mesh
