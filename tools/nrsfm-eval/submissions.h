// What nrsfm-eval is given: files of reconstructions beside one of the truth, or the manifest's sections.
#pragma once
#include <vector>

#include "cli/program.h"
#include "nrsfm/evaluate/evaluation_entries.h"

namespace gonio::tools::nrsfm_eval {

struct Submissions {
  std::vector<nrsfm::Sequence> sequences;
  std::vector<nrsfm::Submission> all;
};
// Of --truth with the files beside it, else of the manifest's sections `sequences` and `reconstructions`.
Submissions submissions_of(cli::Invocation& call);

}  // namespace gonio::tools::nrsfm_eval
