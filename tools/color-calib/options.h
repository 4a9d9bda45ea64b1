// color-calib's options, and what they ask for.
#pragma once
#include <vector>

#include "cli/program.h"
#include "colour/colour_document.h"

namespace gonio::tools::color_calib {

std::vector<cli::Option> options();
// Reads the chart's file where one is named. Error(usage | data | no_input) for what contradicts itself.
colour::ChartRequest request_of(cli::Invocation& call);
void write_specimen(cli::Invocation& call);  // --specimen: picture and image of the manifest

}  // namespace gonio::tools::color_calib
