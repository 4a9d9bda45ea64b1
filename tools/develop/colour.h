// develop --colour: pictures in a camera's numbers to pictures in colours. Options and call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::develop {

std::vector<cli::Option> colour_options();
void check_colour(cli::Invocation& call);
Exit colour(cli::Invocation& call);

}  // namespace gonio::tools::develop
