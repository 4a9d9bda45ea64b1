#include "robot/handeye/consensus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "robot/handeye/closed_forms.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::robot::handeye {
namespace {

constexpr std::size_t most_subsets = 400;
constexpr int most_rounds = 12;
constexpr double false_alarms = 0.01;  // per set of poses

std::vector<PoseError> mismatches(const std::vector<PoseSample>& samples, const Solution& solution, Vec3 middle_m) {
  // The board's place is the median of what the samples say, coordinate by coordinate, so that it needs no majority.
  std::vector<PoseError> list;
  for (const PoseSample& s : samples) {
    list.push_back(difference(board_seen(s, solution.mount_from_camera), solution.stand_from_board, middle_m));
  }
  return list;
}

std::vector<double> distances(const std::vector<PoseError>& errors, const PoseError& unit) {
  std::vector<double> list;
  for (const PoseError& e : errors) {
    list.push_back(std::hypot(e.translation_m / unit.translation_m, e.rotation_rad / unit.rotation_rad));
  }
  return list;
}

PoseError median_of(const std::vector<PoseError>& errors) {
  std::vector<double> t, r;
  for (const PoseError& e : errors) {
    t.push_back(e.translation_m);
    r.push_back(e.rotation_rad);
  }
  return {std::max(1e-12, stats::median(t)), std::max(1e-12, stats::median(r))};
}

std::vector<std::array<std::size_t, 3>> subsets(std::size_t n) {
  std::vector<std::array<std::size_t, 3>> list;
  if (n * (n - 1) * (n - 2) / 6 <= most_subsets) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j)
        for (std::size_t k = j + 1; k < n; ++k) list.push_back({i, j, k});
    return list;
  }
  Random random(20240871);
  while (list.size() < most_subsets) {
    const auto draw = [&] { return static_cast<std::size_t>(random.below(static_cast<std::uint32_t>(n))); };
    const std::array<std::size_t, 3> s{draw(), draw(), draw()};
    if (s[0] != s[1] && s[1] != s[2] && s[0] != s[2]) list.push_back(s);
  }
  return list;
}

std::vector<bool> best_half(const std::vector<double>& distance) {
  std::vector<std::size_t> order(distance.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return distance[i]; });
  std::vector<bool> counts(distance.size(), false);
  const std::size_t half = std::min(distance.size(), std::max<std::size_t>(4, distance.size() / 2 + 1));
  for (std::size_t k = 0; k < half; ++k) counts[order[k]] = true;
  return counts;
}

// Squared distance of six coordinates that a right pose exceeds with this probability, where the noises come from
// `used` poses with 3 used - 6 degrees of freedom each: six times the quantile of the F distribution (Abramowitz &
// Stegun 26.6.2), and more by what the mountings, fitted without the pose, are uncertain themselves (12 parameters from
// 6 used numbers).
double distance_limit2(double probability, double used) {
  const double freedom = std::max(3.0, 3 * used - 6);
  double low = 0, high = 1e6;
  for (int step = 0; step < 100; ++step) {
    const double middle = (low + high) / 2;
    const double above = stats::beta_regularised(freedom / (freedom + middle), freedom / 2, 3);
    (above > probability ? low : high) = middle;
  }
  return low * (1 + 2 / used);
}

}  // namespace

Solution least_median_start(const std::vector<PoseSample>& given, Vec3 middle_m) {
  const ClosedForm& park = closed_form("park", "");
  std::vector<PoseSample> samples = given;
  std::ranges::sort(samples, {}, [](const PoseSample& s) {
    const Vec3 a = s.stand_from_mount.translation_m, b = s.camera_from_board.translation_m;
    return std::array{a.x, a.y, a.z, b.x, b.y, b.z};
  });
  Solution best = park.solve(samples);
  const PoseError unit = median_of(mismatches(samples, best, middle_m));
  double least = stats::median(distances(mismatches(samples, best, middle_m), unit));
  for (const auto& s : subsets(samples.size())) {
    const std::array three{samples[s[0]], samples[s[1]], samples[s[2]]};
    const Solution candidate = park.solve(three);
    const double median = stats::median(distances(mismatches(samples, candidate, middle_m), unit));
    if (median < least) {
      least = median;
      best = candidate;
    }
  }
  return best;
}

Consensus find_consensus(const Setup& setup, const std::vector<View>& views) {
  const std::vector<PoseSample> samples = samples_of(setup, views);
  const auto n = static_cast<double>(views.size());
  const Solution start = least_median_start(samples, setup.middle_m());
  const auto errors = mismatches(samples, start, setup.middle_m());
  Consensus result;
  result.counts =
      views.size() < 5 ? std::vector<bool>(views.size(), true) : best_half(distances(errors, median_of(errors)));
  double shortened = 1.8;  // a half chosen for its small distances shows too small a scatter (consistency at 6 degrees)
  for (int round = 0; round < most_rounds; ++round) {
    result.refined = refine(setup, views, result.counts, start);
    const auto used = static_cast<double>(std::ranges::count(result.counts, true));
    result.limit2 = distance_limit2(false_alarms / n, used) * shortened;
    std::vector<bool> next;
    for (const Mismatch& m : result.refined.mismatches) next.push_back(m.distance2 <= result.limit2);
    if (views.size() < 5 || std::ranges::count(next, true) < 4 || next == result.counts) break;
    result.counts = next;
    shortened = 1;
  }
  if (!std::ranges::all_of(result.refined.mismatches, [](const Mismatch& m) { return std::isfinite(m.distance2); })) {
    result.counts.assign(views.size(), true);
    result.refined = refine(setup, views, result.counts, start);
  }
  return result;
}

}  // namespace gonio::robot::handeye
