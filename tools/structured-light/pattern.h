// The call that writes what a projector shows.
#pragma once
#include "cli/program.h"

namespace gonio::tools::structured_light {

std::vector<cli::Option> pattern_options();
void check_pattern(cli::Invocation& call);
Exit write_pattern(cli::Invocation& call);

}  // namespace gonio::tools::structured_light
