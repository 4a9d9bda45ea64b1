// See tracks_slips.h. A slip lasts: the mean residual over the frames from it on differs from that before by at least
// half of the jump, in its direction.
#include "explain/tables/tracks_slips.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stats/intervals.h"

namespace gonio::explain::tables {
namespace {

constexpr double beyond = 6;
constexpr std::size_t fewest_points = 8, most_slips = 8;

using Residuals = std::vector<std::vector<std::optional<Vec2>>>;  // [frame][point]

std::optional<Vec2> mean_over(const Residuals& r, std::size_t point, std::size_t first, std::size_t last) {
  Vec2 sum;
  double count = 0;
  for (std::size_t f = first; f < last; ++f)
    if (r[f][point]) sum = sum + *r[f][point], count += 1;
  if (count == 0) return {};
  return sum * (1 / count);
}

bool lasts(const Residuals& r, std::size_t point, std::size_t from, Vec2 jump) {
  const auto before = mean_over(r, point, 0, from), after = mean_over(r, point, from, r.size());
  return before && after && dot(*after - *before, jump) > 0.5 * dot(jump, jump);
}

}  // namespace

std::vector<Slip> find_slips(const std::vector<TrackPoint>& track_points, std::size_t frames, std::size_t points) {
  Residuals r(frames, std::vector<std::optional<Vec2>>(points));
  for (const TrackPoint& t : track_points) r[t.frame][t.point] = t.residual_px;
  std::vector<std::pair<double, Slip>> found;
  for (std::size_t f = 1; f < frames; ++f) {
    std::vector<double> along_x, along_y;
    std::vector<std::size_t> who;
    for (std::size_t p = 0; p < points; ++p) {
      if (!r[f][p] || !r[f - 1][p]) continue;
      const Vec2 jump = *r[f][p] - *r[f - 1][p];
      along_x.push_back(jump.x);
      along_y.push_back(jump.y);
      who.push_back(p);
    }
    if (who.size() < fewest_points) continue;
    const double wide_x = stats::robust_sigma(along_x), wide_y = stats::robust_sigma(along_y);
    if (!(wide_x > 0 && wide_y > 0)) continue;
    for (std::size_t k = 0; k < who.size(); ++k) {
      const double size = std::hypot(along_x[k] / wide_x, along_y[k] / wide_y);
      if (size > beyond && lasts(r, who[k], f, {along_x[k], along_y[k]})) found.push_back({size, {who[k], f}});
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
