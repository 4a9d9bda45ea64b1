// The options of structured-light.
#pragma once
#include <string>
#include <vector>

#include "cli/program.h"

namespace gonio::tools::structured_light {

std::vector<cli::Option> options();

// What the numbers of refusals mean: "0 told, 1 masked, ...".
std::string refusals();

}  // namespace gonio::tools::structured_light
