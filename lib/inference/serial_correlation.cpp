// See serial_correlation.h.
#include "inference/serial_correlation.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

struct Sums {
  double products = 0, squares = 0, raw = 0, count = 0;
};

// Over neighbours in the order of one condition, of rows in use.
Sums along(const System& system, const Condition& condition, const std::vector<double>& residual) {
  const Observations& o = system.observations();
  std::vector<std::size_t> rows;
  for (const std::size_t g : system.groups)
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i)
      if (system.weight(i) > 0 && std::isfinite(condition.values[i])) rows.push_back(i);
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return condition.values[a] < condition.values[b]; });
  Sums s;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::size_t i = rows[k - 1], j = rows[k];
    if (o.block[i] == o.block[j]) continue;
    const bool turned = !condition.direction.empty() && condition.direction[i] * condition.direction[j] < 0;
    const double raw = (turned ? -1 : 1) * residual[i] * residual[j];
    const double product = raw * system.weight(i) * system.weight(j);
    s.products += product;
    s.squares += product * product;
    s.raw += raw;
    s.count += 1;
  }
  return s;
}

}  // namespace

std::optional<SerialCorrelation> serial_correlation(const System& system, const std::vector<double>& values) {
  const Observations& o = system.observations();
  if (o.conditions.empty()) return std::nullopt;
  const std::vector<double> residual = system.raw_residual(values);
  double squares = 0, norm = 0, rows = 0;
  for (const std::size_t g : system.groups)
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      const double z = residual[i] * system.weight(i);
      if (!(system.weight(i) > 0)) continue;
      squares += z * z, norm += o.norm[i], rows += 1;
    }
  std::vector<Sums> sums(o.conditions.size());
  parallel_for(0, sums.size(), [&](std::size_t c) { sums[c] = along(system, o.conditions[c], residual); });
  SerialCorrelation best;
  double largest = 0;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    const Sums& s = sums[c];
    const double z = s.squares > 0 ? s.products / std::sqrt(s.squares) : 0;
    if (!(z > largest)) continue;
    largest = z;
    best = {c, 1, s.products / s.count, 0};
    if (system.problem().importance() == Importance::share_of_signal)
      best.effect = norm > 0 ? std::sqrt(std::max(0.0, s.raw / s.count) * rows / norm) : 0;
    else
      best.effect = 1 - std::sqrt(std::max(0.0, 1 - best.power * rows / squares));
  }
  best.p = stats::sidak(stats::normal_upper(largest), static_cast<double>(sums.size()));
  return best;
}

}  // namespace gonio::inference
