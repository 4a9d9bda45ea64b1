// The page about a ground noise: its parts, and how well they follow the spectrum.
#pragma once
#include <string>
#include <vector>

#include "relief/ground_noise.h"

namespace gonio::tools::relief {

// `files`: the maps that it was fitted to, by name.
std::string ground_page(const gonio::relief::GroundNoise& ground, const std::vector<std::string>& files);

}  // namespace gonio::tools::relief
