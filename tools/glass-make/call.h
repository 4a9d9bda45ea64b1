// glass-make behind its description: which cells, where, and what is entered.
#pragma once
#include "cli/program.h"
#include "glass/gather.h"
#include "glass/set.h"

namespace gonio::tools::glass_make {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

std::string page_of(const glass::GlassSet& set, const glass::Gathered& gathered);

}  // namespace gonio::tools::glass_make
