// See refinement.h.
#include "inference/refinement.h"

#include <cmath>

#include "base/progress.h"

namespace gonio::inference {
namespace {

constexpr int rounds = 2;
constexpr double worse = 1.1;  // of the cost, less what the bias scatters: beyond it the two simulate different things

// What the bias' own random numbers add to the cost, at most: the mean, and four standard deviations of such a sum.
double scatter(const System& system, const Bias& bias) {
  double sum = 0, squares = 0;
  for (const std::size_t g : system.groups)
    for (std::size_t i = system.observations().first[g]; i < system.observations().first[g + 1]; ++i) {
      const double share = bias.variance[i] * system.weight(i) * system.weight(i);
      sum += share;
      squares += 2 * share * (2 + share);  // variance of (e + b)^2 less that of e^2, e of unit variance
    }
  return sum + 4 * std::sqrt(squares);
}

}  // namespace

std::optional<Refined> refined(const System& system, const Model& model) {
  std::optional<Refined> result;
  std::optional<Slopes> kept;
  Fit at = model.fit;
  Progress progress("fitting what was found to the exact simulation", rounds);
  for (int round = 0; round < rounds; ++round, progress.advance()) {
    const std::optional<Bias> bias = system.problem().bias(at.values, model.candidates);
    if (!bias) return std::nullopt;
    if (!kept) kept = slopes(system, at.values, at.active);
    System exact = system;
    exact.set_bias(*bias);
    at = fit(exact, at.values, model.fit.active, 60, &*kept);
    if (at.cost - scatter(system, *bias) > worse * model.fit.cost) return std::nullopt;
    result.reset();
    result.emplace(Refined{exact, at});
  }
  return result;
}

}  // namespace gonio::inference
