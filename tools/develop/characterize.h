// develop --characterize: a sensor's figures from frames of even light and of none. Options and call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::develop {

std::vector<cli::Option> characterize_options();
void check_characterize(cli::Invocation& call);
Exit characterize(cli::Invocation& call);

}  // namespace gonio::tools::develop
