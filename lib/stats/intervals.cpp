// See intervals.h.
#include "stats/intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "stats/distributions.h"

namespace gonio::stats {

double quantile(std::span<const double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> v(values.begin(), values.end());
  const double place = std::clamp(p, 0.0, 1.0) * static_cast<double>(v.size() - 1);
  const auto below = v.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(v.begin(), below, v.end());
  const double between = place - std::floor(place);
  if (between == 0) return *below;
  return *below + between * (*std::min_element(below + 1, v.end()) - *below);
}

double median(std::span<const double> values) {
  return quantile(values, 0.5);
}

double robust_sigma(std::span<const double> values) {
  const double centre = median(values);
  std::vector<double> deviation(values.size());
  std::transform(values.begin(), values.end(), deviation.begin(), [&](double v) { return std::abs(v - centre); });
  return sigma_of_median * median(deviation);
}

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standard_error(std::span<const double> values) {
  if (values.size() < 2) return std::numeric_limits<double>::infinity();
  const double centre = mean(values), n = static_cast<double>(values.size());
  double sum = 0;
  for (const double v : values) sum += (v - centre) * (v - centre);
  return std::sqrt(sum / (n * (n - 1)));
}

double sidak(double smallest_p, double looks) {
  if (!(smallest_p < 1)) return 1;
  return -std::expm1(looks * std::log1p(-smallest_p));
}

Interval share_interval(int successes, int trials, double confidence) {
  const double tail = (1 - confidence) / 2;
  // I_x(s, n - s + 1) = P(X >= s | x) rises with x: both ends are its inverses.
  const auto solve = [&](int s, double target) {
    double lower = 0, upper = 1;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (lower + upper);
      (binomial_upper(s, trials, middle) < target ? lower : upper) = middle;
    }
    return 0.5 * (lower + upper);
  };
  return {successes == 0 ? 0 : solve(successes, tail), successes == trials ? 1 : solve(successes + 1, 1 - tail)};
}

double detectable_z(double level, double power) {
  return normal_upper_quantile(level / 2) + normal_quantile(power);
}

}  // namespace gonio::stats
