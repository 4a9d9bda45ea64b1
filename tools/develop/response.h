// develop --find-response: the response of a camera that is not linear, from exposures of one view. Options and call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::develop {

std::vector<cli::Option> response_options();
void check_response(cli::Invocation& call);
Exit find_response(cli::Invocation& call);

}  // namespace gonio::tools::develop
