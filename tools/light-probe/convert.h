// light-probe --convert: from one projection of the sphere to another. Options and call.
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::light_probe {

std::vector<cli::Option> convert_options();
void check_convert(cli::Invocation& call);
Exit convert(cli::Invocation& call);

}  // namespace gonio::tools::light_probe
