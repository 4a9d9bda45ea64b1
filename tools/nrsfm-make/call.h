// nrsfm-make behind its description: which cells of the design, of what deforms, and what is entered.
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::tools::nrsfm_make {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);
Exit make_object(cli::Invocation& call);         // --object without --follow
Exit follow_photographs(cli::Invocation& call);  // --follow

}  // namespace gonio::tools::nrsfm_make
