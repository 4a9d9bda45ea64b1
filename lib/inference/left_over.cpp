// See left_over.h.
#include "inference/left_over.h"

#include <algorithm>
#include <cmath>

namespace gonio::inference {
namespace {

constexpr double price_of_a_look = 10;  // as in the null test
constexpr double mostly_no_noise = 2;   // mean square of a residual over that of its noise

// Does any of the candidates declare the condition as a carrier of its signature?
bool declares(const Problem& problem, const std::vector<std::size_t>& candidates, const std::string& condition) {
  return std::any_of(candidates.begin(), candidates.end(), [&](std::size_t c) {
    const std::vector<std::string>& own = problem.candidates()[c].mechanism->conditions;
    return std::find(own.begin(), own.end(), condition) != own.end();
  });
}

}  // namespace

LeftOver left_over(const Problem& problem, const std::vector<std::size_t>& candidates, const ResidualStructure& after,
                   const Options& options) {
  LeftOver left;
  if (after.global_p > options.level) return left;
  const std::vector<Condition>& conditions = problem.observations().conditions;
  const auto more = [&](double power, std::size_t condition, const std::string& words) {
    if (!(power > left.any)) return;
    left.any = power;
    left.any_over = words;
    left.condition = condition;
  };
  for (const Competitor& c : after.curves) {
    const Hypothesis& h = c.hypothesis;
    if (!(h.gain > 2 * h.gain_sigma) || h.effect < options.smallest_effect) continue;
    more(h.gain, c.condition, "over " + h.name);
    if (h.gain > left.own && declares(problem, candidates, h.name)) left.own = h.gain, left.own_over = h.name;
  }
  const auto tells = [&](const auto& look) {
    return look && price_of_a_look * look->p <= options.level && look->effect >= options.smallest_effect;
  };
  if (const auto& fine = after.serial_correlation; tells(fine))
    more(fine->power, fine->condition, "in a fine structure along " + conditions[fine->condition].name);
  if (const auto& product = after.interaction; tells(product))
    more(product->power, product->first,
         "over the product of " + conditions[product->first].name + " and " + conditions[product->second].name);
  return left;
}

double beyond_noise(const System& system, const std::vector<double>& residual) {
  if (!system.problem().scatter_is_mismatch()) return 0;
  const Observations& o = system.observations();
  double left = 0, noise = 0, norm = 0;
  for (const std::size_t g : system.groups)
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      const double w = system.weight(i);
      if (!(w > 0)) continue;
      left += residual[i] * residual[i], noise += 1 / (w * w), norm += o.norm[i];
    }
  return norm > 0 && left > mostly_no_noise * noise ? std::sqrt((left - noise) / norm) : 0;
}

}  // namespace gonio::inference
