// Evaluations as the manifest and as tables have them.
#pragma once
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "nrsfm/evaluate.h"
#include "nrsfm/submissions.h"

namespace gonio::nrsfm {

// As the manifest's section `evaluations` has it; lengths in metres where the sequence's unit is known.
manifest::Evaluation entry_of(const Submission& submission, const Sequence& sequence, const Evaluated& evaluated,
                              const EvaluationOptions& options);
// One row for each error: id, sequence, algorithm, a column for each factor, measure, alignment, value, interval.
std::string evaluations_csv(const std::vector<manifest::Evaluation>& evaluations);

}  // namespace gonio::nrsfm
