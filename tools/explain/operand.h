// What people give explain(1) without a manifest: a table or a height map, which becomes one; and its folder.
#pragma once
#include "cli/program.h"

namespace gonio::tools::explain {

// The operand FILE, or --table, with the options that say what it is, as call.document. Without one nothing happens.
// Error(usage | data | no_input) in one line.
void read_operand(cli::Invocation& call);

// What is written below --out is named after recordings and domains, and only where there is something to show: asked
// for before the work, by the beginnings of the names. Error(cannot_create) unless --force.
void check_out(const cli::Invocation& call);

}  // namespace gonio::tools::explain
