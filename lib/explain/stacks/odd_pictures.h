// Which pictures of a stack of exposures are brighter or darker than the others say. Starts and the choice of
// candidates only: by how much is fitted, and readings that no fit saw decide whether it is so.
#pragma once
#include <vector>

#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

// By image: median over its sites of the logarithm of reading over exposure, gain and the site's own level. Levels and
// pictures are swept in turn by medians (Tukey, Exploratory Data Analysis, 1977, chapter 11), so that a picture that
// stands out draws no level with it, whatever its weight. 0 where no site is seen.
std::vector<double> standing_out(const Stack& stack, const std::vector<Site>& sites);

}  // namespace gonio::explain::stacks
