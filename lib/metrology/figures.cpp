#include "metrology/figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "manifest/sections/acceptance.h"
#include "stats/intervals.h"

namespace gonio::metrology {
namespace {

constexpr int draws = 200;
constexpr std::size_t fewest_for_bootstrap = 334;  // a point may go

double standard_deviation(std::span<const double> values) {
  const double centre = stats::mean(values);
  double sum = 0;
  for (const double v : values) sum += (v - centre) * (v - centre);
  return values.size() < 2 ? 0 : std::sqrt(sum / (static_cast<double>(values.size()) - 1));
}

double range(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax_element(values);
  return *high - *low;
}

// Mean excess of the largest `m` values over the next one, the scale of an exponential tail.
double tail_scale(std::vector<double> values) {
  const std::size_t m = std::clamp<std::size_t>(values.size() / 50, 3, 30);
  std::ranges::partial_sort(values, values.begin() + static_cast<std::ptrdiff_t>(m + 1), std::greater<>());
  double sum = 0;
  for (std::size_t i = 0; i < m; ++i) sum += values[i] - values[m];
  return sum / static_cast<double>(m);
}

int poisson_one(Random& random) {  // Knuth's product of uniforms
  int k = 0;
  for (double product = random.uniform(); product > 0.36787944117144233; product *= random.uniform()) ++k;
  return k;
}

// Each draw takes every point a Poisson(1) number of times, lets the farthest 0.3 % go where they lie beyond three
// sigmas, and finds the range of the rest. Only the farthest points can take part.
double bootstrap_sigma(const Deviations& deviations, std::uint64_t seed) {
  std::vector<double> all = deviations.kept_m;
  all.insert(all.end(), deviations.rejected_m.begin(), deviations.rejected_m.end());
  const double three_sigmas = rejected_sigmas * stats::robust_sigma(all);
  // The median absolute deviation has 37 % of the efficiency of the standard deviation: variance 1.36 sigma^2 / n.
  const double of_threshold = std::sqrt(1.36 / static_cast<double>(all.size()));
  const auto allowed = static_cast<std::size_t>(rejected_share * static_cast<double>(all.size()));
  const std::size_t candidates = std::min(all.size(), 3 * allowed + 200);
  std::ranges::partial_sort(all, all.begin() + static_cast<std::ptrdiff_t>(candidates),
                            [](double a, double b) { return std::abs(a) > std::abs(b); });
  Random random(seed);
  std::vector<double> ranges;
  for (int draw = 0; draw < draws; ++draw) {
    const double threshold = three_sigmas * (1 + of_threshold * random.normal());
    std::size_t gone = 0;
    double low = 0, high = 0;
    for (std::size_t i = 0; i < candidates && (low == 0 || high == 0); ++i) {
      for (int times = poisson_one(random); times > 0; --times) {
        if (std::abs(all[i]) > threshold && gone < allowed) {
          ++gone;
        } else if (all[i] < 0) {
          low = std::min(low, all[i]);
        } else {
          high = std::max(high, all[i]);
        }
      }
    }
    ranges.push_back(high - low);
  }
  return standard_deviation(ranges);
}

manifest::AcceptanceResult result_of(const char* quantity, const Deviations& deviations, std::uint64_t seed) {
  manifest::AcceptanceResult result;
  const Range r = range_of(deviations, seed);
  result.quantity = quantity;
  result.unit = "m";
  result.value = r.value_m;
  result.uncertainty = r.uncertainty_m;
  result.sigma = standard_deviation(deviations.kept_m);
  result.count = static_cast<std::int64_t>(deviations.kept_m.size());
  result.rejected = static_cast<std::int64_t>(deviations.rejected_m.size());
  return result;
}

}  // namespace

Range range_of(const Deviations& deviations, std::uint64_t seed) {
  Range result{range(deviations.kept_m), 0};
  if (deviations.kept_m.size() + deviations.rejected_m.size() >= fewest_for_bootstrap) {
    result.uncertainty_m = bootstrap_sigma(deviations, seed);
    return result;
  }
  std::vector<double> turned;
  for (const double d : deviations.kept_m) turned.push_back(-d);
  result.uncertainty_m = pi / std::sqrt(6) * std::hypot(tail_scale(deviations.kept_m), tail_scale(turned));
  return result;
}

manifest::AcceptanceResult probing_form(const SphereFit& sphere, std::optional<double> calibrated_radius_m,
                                        std::uint64_t seed) {
  manifest::AcceptanceResult result = result_of("probing-form", sphere.deviations, seed);
  const double mean = stats::mean(sphere.deviations.kept_m);
  if (calibrated_radius_m) result.bias = mean + sphere.radius_m - *calibrated_radius_m;
  return result;
}

manifest::AcceptanceResult probing_size(const SphereFit& sphere, double calibrated_radius_m) {
  manifest::AcceptanceResult result;
  result.quantity = "probing-size";
  result.unit = "m";
  result.value = 2 * (sphere.radius_m - calibrated_radius_m);
  result.uncertainty = 2 * sphere.radius_sigma_m();
  result.count = static_cast<std::int64_t>(sphere.deviations.kept_m.size());
  result.rejected = static_cast<std::int64_t>(sphere.deviations.rejected_m.size());
  return result;
}

manifest::AcceptanceResult sphere_distance(const SphereFit& a, const SphereFit& b, double calibrated_m) {
  manifest::AcceptanceResult result;
  const Vec3 between = b.centre_m - a.centre_m;
  const double distance = norm(between);
  double variance = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const auto k = static_cast<std::size_t>(4 * i + j);
      variance += between[i] * between[j] * (a.covariance[k] + b.covariance[k]);
    }
  result.quantity = "sphere-distance";
  result.unit = "m";
  result.value = distance - calibrated_m;
  result.uncertainty = std::sqrt(variance) / distance;
  return result;
}

manifest::AcceptanceResult flatness(const PlaneFit& plane, std::uint64_t seed) {
  return result_of("flatness", plane.deviations, seed);
}

std::vector<manifest::AcceptanceResult> summaries(std::span<const manifest::AcceptanceResult> results) {
  std::vector<manifest::AcceptanceResult> found;
  for (const char* quantity : {"probing-form", "probing-size", "sphere-distance", "flatness"}) {
    std::vector<double> values;
    const manifest::AcceptanceResult* worst = nullptr;
    for (const auto& r : results) {
      if (r.quantity != quantity) continue;
      values.push_back(r.value);
      if (worst == nullptr || std::abs(r.value) > std::abs(worst->value)) worst = &r;
    }
    if (values.size() < 2) continue;
    manifest::AcceptanceResult summary;
    summary.quantity = quantity;
    summary.unit = "m";
    summary.value = worst->value;
    summary.uncertainty = worst->uncertainty;
    summary.bias = stats::mean(values);
    summary.sigma = standard_deviation(values);
    summary.count = static_cast<std::int64_t>(values.size());
    found.push_back(summary);
  }
  return found;
}

}  // namespace gonio::metrology
