// The program `brdf-fit` behind its command line: what to read, what to fit, what to write.
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::goniometry {

std::vector<cli::Option> brdf_options();
void check_brdf(cli::Invocation& call);
Exit fit_brdf(cli::Invocation& call);

}  // namespace gonio::goniometry
