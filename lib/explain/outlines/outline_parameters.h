// The parameters of the outlines problem and the candidates they make. Private to outlines/.
#pragma once
#include <optional>
#include <vector>

#include "explain/outlines/outline_model.h"

namespace gonio::explain {

inline constexpr double of_typical = 0.1;  // a candidate's Parameter::size, over what is typical of its mechanism

struct OutlineParameters {
  std::vector<Parameter> parameters;
  std::vector<std::size_t> base;
  std::vector<Candidate> candidates;
  std::optional<std::size_t> lit_inside;  // the candidate that is tested apart
};
// Fills the freedoms and roles of `model`. Candidates have all parameters, estimable or not.
OutlineParameters outline_parameters(const OutlinesInput& input, OutlineModel& model);

}  // namespace gonio::explain
