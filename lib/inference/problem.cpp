// See problem.h: what a domain has that says nothing of its own.
#include "inference/problem.h"

#include <algorithm>

namespace gonio::inference {

// Central differences with step h = 1e-4 size: error h^2 f''' / 6 + rounding / h, both near 1e-8 of the change for
// smooth f. At a bound the step leads inwards only.
void Problem::jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                       std::span<double> derivatives) const {
  const std::size_t rows = observations_.first[group + 1] - observations_.first[group];
  std::vector<double> moved(values.begin(), values.end()), above(rows), below(rows);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Parameter& p = parameters_[columns[k]];
    const double centre = values[columns[k]], step = 1e-4 * p.size;
    const double upper = std::min(centre + step, std::max(p.upper, centre));
    const double lower = std::max(centre - step, std::min(p.lower, centre));
    moved[columns[k]] = upper;
    predict(moved, group, above);
    moved[columns[k]] = lower;
    predict(moved, group, below);
    moved[columns[k]] = centre;
    const double scale = upper > lower ? 1 / (upper - lower) : 0;
    for (std::size_t i = 0; i < rows; ++i) derivatives[k * rows + i] = (above[i] - below[i]) * scale;
  }
}

std::optional<double> Problem::noise_factor(std::span<const double>) const {
  return std::nullopt;
}

std::optional<Calibration> Problem::calibration(std::size_t parameter) const {
  const Parameter& p = parameters_[parameter];
  if (!p.prior_sigma) return std::nullopt;
  return Calibration{p.start, p.prior_sigma};
}

std::string Problem::remarks(const Explanation&) const {
  return {};
}

ProposedRows Problem::propose(std::span<const double>, std::size_t) const {
  return {};
}

}  // namespace gonio::inference
