// See tracks_slips.h.
#include "explain/tables/tracks_slips.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stats/intervals.h"

namespace gonio::explain::tables {
namespace {

constexpr double beyond = 6;
constexpr std::size_t fewest_points = 8;

using Residuals = std::vector<std::vector<std::optional<Vec2>>>;  // [frame][point]

std::optional<Vec2> mean_over(const Residuals& r, std::size_t point, std::size_t first, std::size_t last) {
  Vec2 sum;
  double count = 0;
  for (std::size_t f = first; f < last; ++f)
    if (r[f][point]) sum = sum + *r[f][point], count += 1;
  if (count == 0) return {};
  return sum * (1 / count);
}

struct Step {
  std::size_t point = 0;
  Vec2 by;
};
// Of every point that is seen on both sides of frame `from`.
std::vector<Step> steps_at(const Residuals& r, std::size_t from, std::size_t points) {
  std::vector<Step> steps;
  for (std::size_t p = 0; p < points; ++p) {
    const auto before = mean_over(r, p, 0, from), after = mean_over(r, p, from, r.size());
    if (before && after) steps.push_back({p, *after - *before});
  }
  return steps;
}

}  // namespace

std::vector<Slip> find_slips(const std::vector<TrackPoint>& track_points, std::size_t frames, std::size_t points) {
  Residuals r(frames, std::vector<std::optional<Vec2>>(points));
  for (const TrackPoint& t : track_points) r[t.frame][t.point] = t.residual_px;
  std::vector<std::pair<double, Slip>> found;
  for (std::size_t f = 1; f < frames; ++f) {
    const std::vector<Step> steps = steps_at(r, f, points);
    if (steps.size() < fewest_points) continue;
    std::vector<double> along_x, along_y;
    for (const Step& s : steps) along_x.push_back(s.by.x), along_y.push_back(s.by.y);
    const double wide_x = stats::robust_sigma(along_x), wide_y = stats::robust_sigma(along_y);
    if (!(wide_x > 0 && wide_y > 0)) continue;
    for (const Step& s : steps) {
      const double size = std::hypot(s.by.x / wide_x, s.by.y / wide_y);
      if (size > beyond) found.push_back({size, {s.point, f, s.by * (1 / std::hypot(s.by.x, s.by.y))}});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Slip> slips;
  for (const auto& [size, slip] : found) {
    const auto same = [&, s = slip](const Slip& other) { return other.point == s.point; };
    if (slips.size() < most_slips && std::none_of(slips.begin(), slips.end(), same)) slips.push_back(slip);
  }
  return slips;
}

}  // namespace gonio::explain::tables
