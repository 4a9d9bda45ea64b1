// The command line of `lobe`: lobes of height maps as tables, pictures, a page and sections of the manifest, with the
// surface that stands for each map (lobe_surface.h).
#pragma once
#include <vector>

#include "cli/program.h"

namespace gonio::relief {

std::vector<cli::Option> lobe_options();
void check_lobe_call(cli::Invocation& call);
Exit lobe_call(cli::Invocation& call);

}  // namespace gonio::relief
