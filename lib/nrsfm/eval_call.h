// The program `nrsfm-eval` behind its command line: which reconstructions are held against which truth, and what is
// written. What it is made of: submissions.h (what it is given), evaluate.h (the errors), evaluation_entries.h (what it
// says of them), analysis.h (what decides them).
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::nrsfm {

std::vector<cli::Option> eval_options();
void check_eval(cli::Invocation& call);
Exit run_eval(cli::Invocation& call);

}  // namespace gonio::nrsfm
