// develop --undistort: photographs without the lens's distortion. Options and call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::develop {

std::vector<cli::Option> undistort_options();
void check_undistort(cli::Invocation& call);
Exit undistort(cli::Invocation& call);

}  // namespace gonio::tools::develop
