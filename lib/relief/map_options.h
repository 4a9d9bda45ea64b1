// Options that programs which read height maps share: what the numbers of a picture mean (io/height_map.h), and what is
// taken off the heights first (areal.h).
#pragma once
#include <vector>

#include "cli/program.h"
#include "io/height_map.h"
#include "relief/areal.h"

namespace gonio::relief {

std::vector<cli::Option> picture_options();  // --step, --step-y, --unit, --channel
std::vector<cli::Option> map_options();      // these, --levelling and the filters
io::HeightPicture picture_asked(const cli::Invocation& call);
Treatment treatment_asked(const cli::Invocation& call);
const std::vector<std::string>& levelling_names();

}  // namespace gonio::relief
