// The options of `relief`.
#pragma once
#include <vector>

#include "cli/program.h"
#include "relief/noise.h"

namespace gonio::tools::relief {

std::vector<cli::Option> options();
std::vector<gonio::relief::NoisePart> parts_asked(const cli::Invocation& call);  // --sq and --cell, pair by pair

}  // namespace gonio::tools::relief
