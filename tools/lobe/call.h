// The command line of `lobe`: lobes of height maps as tables, pictures, a page and sections of the manifest, with the
// surface that stands for each map (lobe_surface.h).
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::tools::lobe {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

}  // namespace gonio::tools::lobe
