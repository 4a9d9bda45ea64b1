// brdf-fit behind its description: what to read, what to fit, what to write.
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::tools::brdf_fit {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

}  // namespace gonio::tools::brdf_fit
