// The options of `relief`, and the page about a ground noise.
#pragma once
#include <string>
#include <vector>

#include "cli/program.h"
#include "relief/ground_noise.h"

namespace gonio::relief {

std::vector<cli::Option> relief_options();
std::vector<NoisePart> parts_asked(const cli::Invocation& call);  // --sq and --cell, pair by pair
std::string ground_page(const GroundNoise& ground, const std::vector<std::string>& files);

}  // namespace gonio::relief
