// The options of structured-light.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::structured_light {

std::vector<cli::Option> options();

}  // namespace gonio::tools::structured_light
