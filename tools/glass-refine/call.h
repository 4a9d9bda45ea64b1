// glass-refine behind its description.
#pragma once
#include "cli/program.h"

namespace gonio::tools::glass_refine {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

}  // namespace gonio::tools::glass_refine
