// The manifest's clouds as points of views.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "mesh/reconstruct.h"

namespace gonio::mesh {

// Those of `wished`, all where it is empty. Error(usage) for names that are none, and for viewpoints of other clouds.
std::vector<std::string> chosen_clouds(const manifest::Document& document, const std::vector<std::string>& wished,
                                       const std::map<std::string, Vec3>& viewpoints_m);

std::filesystem::path cloud_path(const manifest::Document& document, const std::string& cloud);

// In the order of `names`. Error(data) where a cloud cannot be used.
MeasuredPoints points_of_clouds(const manifest::Document& document, const std::vector<std::string>& names,
                                const std::map<std::string, Vec3>& viewpoints_m);

}  // namespace gonio::mesh
