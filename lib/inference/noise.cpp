// See noise.h.
#include "inference/noise.h"

#include <cmath>
#include <map>

#include "stats/intervals.h"

namespace gonio::inference {

NoiseFindings settle_noise(System& system, const std::vector<double>& start) {
  NoiseFindings findings;
  const Problem& problem = system.problem();
  if (!problem.noise_factor(system.raw_residual(start)) && !problem.sets_outliers_aside()) return findings;
  std::vector<std::size_t> active = problem.base();
  std::map<std::string, bool> taken;
  std::vector<double> values = start;
  const auto take = [&](const Candidate& c) {
    std::string family = c.family.empty() ? c.id() : c.family;
    for (const std::string& on : c.on) family += "/" + on;
    if (!taken.try_emplace(family, true).second) return;
    for (const std::size_t p : c.parameters) {
      active.push_back(p);
      values[p] = problem.parameters()[p].start;
    }
  };
  // Of one family the plain form: a finer one follows single strays where there are few groups.
  for (const bool finer : {false, true})
    for (const Candidate& c : problem.candidates())
      if (c.finer == finer) take(c);
  const Fit flexible = fit(system, values, active);
  const std::vector<double> residual = system.raw_residual(flexible.values);
  findings.factor = problem.noise_factor(residual).value_or(1.0);
  system.set_noise_factor(findings.factor);
  if (!problem.sets_outliers_aside()) return findings;

  const Observations& o = problem.observations();
  // The mean square of the bulk, so that a model that is merely imperfect throws nothing away.
  std::map<std::uint32_t, std::pair<double, double>> blocks;
  for (std::size_t i = 0; i < o.rows(); ++i) {
    const double z = residual[i] * system.weight(i);
    auto& [sum, count] = blocks[o.block[i]];
    sum += z * z;
    count += 1;
  }
  std::vector<double> level;
  for (const auto& [block, s] : blocks) level.push_back(s.first / s.second);
  // Median of chi-square with two degrees over its mean is ln 2; for more rows a block it rises towards one.
  const double bulk = std::max(1.0, stats::median(level) / std::log(2.0));
  for (const auto& [block, s] : blocks) {
    if (s.first / s.second <= 25 * bulk) continue;
    system.set_aside(block);
    ++findings.outlier_blocks;
  }
  return findings;
}

}  // namespace gonio::inference
