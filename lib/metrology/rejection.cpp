#include "metrology/rejection.h"

#include <algorithm>
#include <cmath>

#include "stats/intervals.h"

namespace gonio::metrology {
namespace {

// Distances from the median, and their robust standard deviation.
struct Spread {
  std::vector<double> distances;
  double sigma = 0;
};

Spread spread_of(std::span<const double> deviations_m) {
  Spread spread{{deviations_m.begin(), deviations_m.end()}, 0};
  const double centre = stats::median(spread.distances);
  for (double& d : spread.distances) d = std::abs(d - centre);
  spread.sigma = stats::sigma_of_median * stats::median(spread.distances);
  return spread;
}

}  // namespace

std::vector<std::size_t> rejected_points(std::span<const double> deviations_m) {
  const auto allowed = static_cast<std::size_t>(rejected_share * static_cast<double>(deviations_m.size()));
  if (allowed == 0) return {};
  const Spread spread = spread_of(deviations_m);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < deviations_m.size(); ++i)
    if (spread.distances[i] > rejected_sigmas * spread.sigma) out.push_back(i);
  std::ranges::sort(out, [&](std::size_t a, std::size_t b) {
    const double da = spread.distances[a], db = spread.distances[b];
    return da > db || (da == db && a < b);
  });
  if (out.size() > allowed) out.resize(allowed);
  std::ranges::sort(out);
  return out;
}

Deviations sorted_out(std::span<const double> deviations_m, std::span<const std::size_t> rejected) {
  Deviations result;
  const Spread spread = spread_of(deviations_m);
  std::size_t next = 0, beyond = 0;
  for (std::size_t i = 0; i < deviations_m.size(); ++i) {
    if (next < rejected.size() && rejected[next] == i) {
      result.rejected_m.push_back(deviations_m[i]);
      ++next;
      continue;
    }
    result.kept_m.push_back(deviations_m[i]);
    if (spread.distances[i] > rejected_sigmas * spread.sigma) ++beyond;
  }
  result.still_beyond = static_cast<double>(beyond) / static_cast<double>(deviations_m.size());
  return result;
}

std::vector<std::uint32_t> cells_of(std::span<const Vec3> points_m) {
  Vec3 lower = points_m[0], upper = points_m[0];
  for (const Vec3& p : points_m) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  const double side = max_component(upper - lower) / 8;
  const auto place = [&](double v) { return static_cast<std::uint32_t>(std::min(7.0, std::floor(v / side))); };
  std::vector<std::uint32_t> cells;
  for (const Vec3& p : points_m) {
    const Vec3 d = p - lower;
    cells.push_back(side > 0 ? 64 * place(d.x) + 8 * place(d.y) + place(d.z) : 0);
  }
  return cells;
}

}  // namespace gonio::metrology
