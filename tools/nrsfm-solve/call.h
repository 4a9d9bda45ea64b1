// nrsfm-solve behind its description: which solvers, of which sequences, and what is written.
//
// Every pair of a sequence and a solver is a job. Jobs run side by side; each writes its file as soon as it has
// answered, and the manifest's entries follow in the order of sequences and solvers, so that neither depends on the
// number of threads. A solver that cannot take a sequence, or fails on it, leaves its reason in the sequence's notes;
// the call fails where no job has an answer.
#pragma once
#include <vector>

#include "base/error.h"
#include "cli/program.h"

namespace gonio::tools::nrsfm_solve {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

}  // namespace gonio::tools::nrsfm_solve
