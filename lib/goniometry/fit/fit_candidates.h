// Which fits are tried: every registered model in its variants, and why others are not.
#pragma once
#include <vector>

#include "goniometry/fit/fit_problem.h"

namespace gonio::goniometry {

// Simplest first. `least`: roughness below which these angles tell nothing. Error(data) at `place` for unknown ids.
std::vector<Candidate> candidates(const FitOptions& options, bool anisotropic, double least, const std::string& place,
                                  std::vector<Refusal>& refusals);

}  // namespace gonio::goniometry
