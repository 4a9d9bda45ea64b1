// nrsfm-eval behind its description: which reconstructions are held against which truth, and what is written. What it
// is made of: submissions.h (what it is given), nrsfm/evaluate/evaluate.h (the errors),
// nrsfm/evaluate/evaluation_entries.h (what is said of them), analysis.h (what decides them).
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::tools::nrsfm_eval {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

}  // namespace gonio::tools::nrsfm_eval
