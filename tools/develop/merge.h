// develop --merge: raw frames to radiance. Options and call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::develop {

std::vector<cli::Option> merge_options();
void check_merge(cli::Invocation& call);
Exit merge(cli::Invocation& call);

}  // namespace gonio::tools::develop
