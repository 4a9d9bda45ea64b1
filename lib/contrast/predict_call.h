// The command line of `contrast predict`: its options, and what it does with them.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::contrast {

std::vector<cli::Option> predict_options();
void predict_check(cli::Invocation& call);  // Error(usage | no_input) for options that do not fit together
Exit predict_call(cli::Invocation& call);

}  // namespace gonio::contrast
