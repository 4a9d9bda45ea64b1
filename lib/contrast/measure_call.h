// The command line of `contrast measure`: its options, what can be refused at once, and the call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::contrast {

std::vector<cli::Option> measure_options();
void measure_check(cli::Invocation& call);
Exit measure_call(cli::Invocation& call);

}  // namespace gonio::contrast
