// The program `nrsfm-make` behind its command line: which cells of the design, of what deforms, and what is entered.
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::nrsfm {

std::vector<cli::Option> make_options();
void check_make(cli::Invocation& call);
Exit run_make(cli::Invocation& call);

}  // namespace gonio::nrsfm
