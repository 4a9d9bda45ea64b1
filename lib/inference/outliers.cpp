// See outliers.h.
#include "inference/outliers.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "inference/system.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr double widths = 5;  // as blocks are set aside elsewhere (noise.cpp)
constexpr std::size_t enough_places = 8;

}  // namespace

std::optional<Outliers> outliers(const System& system, const std::vector<double>& values) {
  if (!system.problem().outliers_are_effects()) return std::nullopt;
  const Observations& o = system.observations();
  const std::vector<double> residual = system.raw_residual(values);
  // Of a row's residual, what its place does not excuse.
  const auto unexcused = [&](std::size_t i) {
    return std::max(0.0, std::abs(residual[i]) - (o.place_error.empty() ? 0 : o.place_error[i]));
  };
  std::vector<double> size;
  double squares = 0, norm = 0;
  for (const std::size_t g : system.groups)
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      if (!(system.weight(i) > 0)) continue;
      const double z = residual[i] * system.weight(i);
      size.push_back(std::abs(z));
      squares += z * z, norm += o.norm[i];
    }
  if (size.empty()) return std::nullopt;
  const double limit = widths * std::max(1.0, stats::sigma_of_median * stats::median(size));
  Outliers found;
  double raw = 0, power = 0;
  std::set<std::uint32_t> blocks;
  for (const std::size_t g : system.groups) {
    const std::size_t known = found.readings;
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      const double off = unexcused(i), z = off * system.weight(i);
      if (!(z > limit)) continue;
      ++found.readings;
      blocks.insert(o.block[i]);
      power += z * z, raw += off * off;
    }
    if (found.readings > known) found.of_groups.emplace_back(g, found.readings - known);
  }
  found.places = blocks.size();
  if (found.places < enough_places) return std::nullopt;
  std::ranges::stable_sort(found.of_groups, [](const auto& a, const auto& b) { return a.second > b.second; });
  found.power = power / static_cast<double>(size.size());
  if (system.problem().importance() == Importance::share_of_signal)
    found.effect = norm > 0 ? std::sqrt(raw / norm) : 0;
  else
    found.effect = 1 - std::sqrt(std::max(0.0, 1 - power / squares));
  return found;
}

}  // namespace gonio::inference
