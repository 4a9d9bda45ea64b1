// Height maps and lobes in false colours.
#pragma once
#include <utility>

#include "io/height_map.h"
#include "io/image.h"
#include "relief/lobe.h"

namespace gonio::relief {

std::pair<double, double> range_of(const io::HeightMap& map);  // lowest and highest measured point, m
io::Image picture_of(const io::HeightMap& map);                // rows from the top; missing points magenta
// Logarithmic over `decades` below the largest value (0: linear); the unit disc, white outside of it.
io::Image picture_of(const LobeTable& lobe, double decades);

}  // namespace gonio::relief
