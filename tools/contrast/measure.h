// The command line of `contrast measure`: its options, what can be refused at once, and the call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::contrast {

std::vector<cli::Option> measure_options();
void check_measure(cli::Invocation& call);
Exit run_measure(cli::Invocation& call);

}  // namespace gonio::tools::contrast
