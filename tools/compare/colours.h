// Photographs that hold what a camera reads, against renderings in colours.
#pragma once
#include <vector>

#include "cli/program.h"
#include "metric/entries.h"

namespace gonio::tools::compare {

cli::Option colour_option();
// Where --colour is given, every photograph of these goes through that correction of the manifest.
std::vector<metric::Entry> in_colours(const cli::Invocation& call, std::vector<metric::Entry> entries);

}  // namespace gonio::tools::compare
