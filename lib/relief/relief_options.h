// The options of `relief` and what it says of a ground noise, in JSON and as a page.
#pragma once
#include <string>
#include <vector>

#include "cli/program.h"
#include "manifest/value.h"
#include "relief/ground_noise.h"

namespace gonio::relief {

std::vector<cli::Option> relief_options();
std::vector<NoisePart> parts_asked(const cli::Invocation& call);          // --sq and --cell, pair by pair
manifest::Value ground_value(const GroundNoise& ground, double layer_m);  // weights where there is a layer's thickness
std::string ground_page(const GroundNoise& ground, const std::vector<std::string>& files);

}  // namespace gonio::relief
