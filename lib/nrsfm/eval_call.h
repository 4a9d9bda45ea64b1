// The program `nrsfm-eval` behind its command line: which reconstructions, against which truth, and what is written.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "cli/program.h"
#include "nrsfm/evaluate.h"

namespace gonio::nrsfm {

std::vector<cli::Option> eval_options();
void check_eval(cli::Invocation& call);
Exit run_eval(cli::Invocation& call);

// One reconstruction with the sequence whose truth it is held against.
struct Submission {
  std::string id;
  std::size_t sequence = 0;  // of Submissions::sequences
  Reconstruction reconstruction;
  std::vector<std::string> notes;
};
struct Submissions {
  std::vector<Sequence> sequences;
  std::vector<Submission> all;
};
// Of the manifest's sections `sequences` and `reconstructions`, and of --truth with the files beside it.
Submissions submissions_of(cli::Invocation& call);

// As the manifest's section `evaluations` has it; lengths in metres where the sequence's unit is known.
manifest::Evaluation entry_of(const Submission& submission, const Sequence& sequence, const Evaluated& evaluated,
                              const EvaluationOptions& options);
// One row for each error: id, sequence, algorithm, a column for each factor, measure, alignment, value, interval.
std::string evaluations_csv(const std::vector<manifest::Evaluation>& evaluations);

}  // namespace gonio::nrsfm
