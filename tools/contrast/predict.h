// The command line of `contrast predict`: its options, and what it does with them.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::contrast {

std::vector<cli::Option> predict_options();
void check_predict(cli::Invocation& call);  // Error(usage | no_input) for options that do not fit together
Exit run_predict(cli::Invocation& call);

}  // namespace gonio::tools::contrast
