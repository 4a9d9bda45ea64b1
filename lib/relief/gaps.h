// Points of a height map that the instrument could not measure, filled by a membrane: Laplace's equation over each gap
// with the measured points about it as its rim, by successive over-relaxation (Young 1954).
#pragma once
#include <cstddef>
#include <string>

#include "io/height_map.h"

namespace gonio::relief {

// How many points it filled. Error(data) at `place` where more than half are missing.
std::size_t fill_gaps(io::HeightMap& map, const std::string& place);

}  // namespace gonio::relief
