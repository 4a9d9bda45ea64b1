// Evaluations as the manifest and as tables have them.
#pragma once
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "nrsfm/evaluate/evaluate.h"

namespace gonio::nrsfm {

// One reconstruction that is held against a truth.
struct Submission {
  std::string id;
  std::size_t sequence = 0;  // whose truth, of the sequences at hand
  Reconstruction reconstruction;
  std::vector<std::string> notes;
};

// As the manifest's section `evaluations` has it; lengths in metres where the sequence's unit is known.
manifest::Evaluation entry_of(const Submission& submission, const Sequence& sequence, const Evaluated& evaluated,
                              const EvaluationOptions& options);
// One row for each error: id, sequence, algorithm, a column for each factor, measure, alignment, value, interval.
std::string evaluations_csv(const std::vector<manifest::Evaluation>& evaluations);

}  // namespace gonio::nrsfm
