// nrsfm-make behind its description: which cells of the design, of what deforms, and what is entered.
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::tools::nrsfm_make {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

}  // namespace gonio::tools::nrsfm_make
