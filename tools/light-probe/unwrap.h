// light-probe: photographs of mirror balls to surroundings and lights. Options and call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::light_probe {

std::vector<cli::Option> unwrap_options();
void check_unwrap(cli::Invocation& call);
Exit unwrap(cli::Invocation& call);

}  // namespace gonio::tools::light_probe
