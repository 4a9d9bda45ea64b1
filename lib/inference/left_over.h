// What a model leaves that matters, as its residual structure tells.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "inference/race.h"

namespace gonio::inference {

// In squared noise per observation, and where.
struct LeftOver {
  double own = 0, any = 0;
  std::string own_over, any_over;
  std::optional<std::size_t> condition;  // that carries most of it
};
LeftOver left_over(const Problem& problem, const std::vector<std::size_t>& candidates, const ResidualStructure& after,
                   const Options& options);

// What raw residuals (of System::raw_residual) leave beyond the noise, root mean square as a share of the signal; 0
// where most of it may be noise, or where the problem does not know the noise of single readings
// (Problem::scatter_is_mismatch).
double beyond_noise(const System& system, const std::vector<double>& residual);

}  // namespace gonio::inference
