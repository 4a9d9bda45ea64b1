// See odd_group.h.
#include "inference/odd_group.h"

#include <algorithm>

#include "inference/fit.h"
#include "inference/race.h"
#include "inference/system.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr std::size_t fewest_groups = 5, most_groups = 40;
constexpr double most_rows = 1e6;                  // rows times fits
constexpr double under = 0.1, others_above = 0.5;  // of the median

// Cost of each fit over its rows, the groups left out in turn.
std::vector<double> costs(const System& all, const std::vector<double>& start, const std::vector<std::size_t>& active) {
  const Fit joint = fit(all, start, active);
  std::vector<double> result;
  for (const std::size_t g : all.groups) {
    System others = all;
    std::erase(others.groups, g);
    std::size_t rows = 0;
    for (const std::size_t other : others.groups) rows += others.used_rows(other);
    const double from_joint = fit(others, joint.values, active).cost, anew = fit(others, start, active).cost;
    result.push_back(std::min(from_joint, anew) / static_cast<double>(std::max<std::size_t>(1, rows)));
  }
  return result;
}

}  // namespace

bool odd_group_can_be_asked(const System& system) {
  const std::size_t groups = system.groups.size(), hypotheses = system.problem().candidates().size() + 1;
  if (groups < fewest_groups || groups > most_groups) return false;
  double rows = 0;
  for (const std::size_t g : system.groups) rows += static_cast<double>(system.used_rows(g));
  return rows * static_cast<double>(groups * hypotheses) <= most_rows;
}

std::optional<std::size_t> odd_group(const Race& race, const std::vector<double>& start) {
  const System& system = race.system();
  std::optional<std::size_t> odd;
  double least = under;
  const auto ask = [&](const std::vector<double>& from, const std::vector<std::size_t>& active) {
    const std::vector<double> cost = costs(system, from, active);
    std::vector<double> sorted = cost;
    std::sort(sorted.begin(), sorted.end());
    const double middle = stats::median(cost);
    if (!(middle > 0) || sorted[1] < others_above * middle || sorted[0] / middle >= least) return;
    least = sorted[0] / middle;
    odd = system.groups[static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin())];
  };
  const Problem& problem = system.problem();
  ask(start, race.free());
  for (const std::size_t c : race.allowed()) {
    std::vector<double> from = start;
    std::vector<std::size_t> active = race.free();
    for (const std::size_t p : problem.candidates()[c].parameters) {
      from[p] = problem.parameters()[p].start;
      active.push_back(p);
    }
    std::sort(active.begin(), active.end());
    ask(from, active);
  }
  return odd;
}

}  // namespace gonio::inference
