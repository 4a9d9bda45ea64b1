// The page of nrsfm-eval: what was measured, how it is spread over algorithms, which frames are flipped, what decides,
// and the shapes themselves.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/sections/evaluation.h"
#include "manifest/sections/forward.h"
#include "nrsfm/evaluate/analysis.h"
#include "tools/nrsfm-eval/views.h"

namespace gonio::tools::nrsfm_eval {

struct EvaluationPage {
  std::vector<manifest::Evaluation> evaluations;  // of this call; empty: an analysis only
  std::vector<View> views;
  std::optional<nrsfm::Analysis> analysis;
};
std::string evaluation_page(const EvaluationPage& page);

}  // namespace gonio::tools::nrsfm_eval
