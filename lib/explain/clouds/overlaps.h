// Clouds of no known shape against each other, where they overlap. Private to clouds/.
#pragma once
#include "explain/clouds/clouds_problem.h"

namespace gonio::explain {

// Fills clouds, views, against. A pair of clouds is an overlap where enough points of the first are seen by the second
// on one smooth surface that both look at: their normals agree, and neither is at an edge. A point is held against that
// of the other which is seen next to it: what either lies off the smooth surface, below its own place. Error(data)
// where there are fewer than `fewest_clouds`.
void add_overlaps(const manifest::Document& document, const std::vector<std::string>& names, CloudsInput& input);

}  // namespace gonio::explain
