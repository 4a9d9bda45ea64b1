// The report of height maps: the map, its heights, its normals, the figures.
#pragma once
#include <string>
#include <vector>

#include "relief/measured.h"

namespace gonio::tools::roughness {

std::string roughness_page(const std::vector<relief::Measured>& all);

}  // namespace gonio::tools::roughness
