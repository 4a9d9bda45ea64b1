// Points with covariances from PLY files, as structured-light writes them.
#pragma once
#include <filesystem>

#include "mesh/reconstruct.h"

namespace gonio::mesh {

// Appends the file's points as those of `view`: cov_xx ... cov_zz, or else sigma in every direction; red, green, blue
// where the file has them. Error(data) naming the first point that cannot be used.
void read_points(const std::filesystem::path& path, std::uint32_t view, MeasuredPoints& points);

}  // namespace gonio::mesh
