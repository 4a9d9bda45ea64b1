// What nrsfm-eval is given: files of reconstructions beside one of the truth, or the manifest's sections.
#pragma once
#include <string>
#include <vector>

#include "cli/program.h"
#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

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
// Of --truth with the files beside it, else of the manifest's sections `sequences` and `reconstructions`.
Submissions submissions_of(cli::Invocation& call);

}  // namespace gonio::nrsfm
