// Scales: a tomograph in millimetres, a voxel size that was not set.
#include <algorithm>
#include <cmath>
#include <map>

#include "reassembly/pair_match.h"

namespace gonio::reassembly {
namespace {

struct TriangleShape {  // a triangle: its longest side and, over that, the other two
  double middle, shortest, longest;
};

std::vector<TriangleShape> shapes_of(std::span<const Spot> spots, const std::vector<std::size_t>& of) {
  std::vector<TriangleShape> out;
  for (std::size_t i = 0; i < of.size(); ++i)
    for (std::size_t j = i + 1; j < of.size(); ++j)
      for (std::size_t k = j + 1; k < of.size(); ++k) {
        std::array<double, 3> s{(spots[of[i]].at - spots[of[j]].at).norm(), (spots[of[i]].at - spots[of[k]].at).norm(),
                                (spots[of[j]].at - spots[of[k]].at).norm()};
        std::ranges::sort(s);
        if (s[0] > 0.05 * s[2]) out.push_back({s[1] / s[2], s[0] / s[2], s[2]});
      }
  std::ranges::sort(out, {}, &TriangleShape::middle);
  return out;
}

}  // namespace

std::vector<double> likely_scales(std::span<const Spot> markers, const Points& points, std::size_t most) {
  constexpr std::size_t most_points = 48, most_votes = 2000000;
  constexpr double alike = 0.02, bin = 0.02;
  std::vector<std::size_t> all(markers.size()), open;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  for (std::size_t b = 0; b < points.spots.size(); ++b)
    if (points.open[b]) open.push_back(b);
  // The surest points first, where there are too many.
  std::ranges::stable_sort(open, {}, [&](std::size_t b) { return points.spots[b].covariance.trace(); });
  if (open.size() > most_points) open.resize(most_points);
  const auto shapes = shapes_of(markers, all), seen = shapes_of(points.spots, open);
  std::map<long, int> votes;
  std::size_t cast = 0;
  for (const TriangleShape& s : shapes)
    for (auto at = std::ranges::lower_bound(seen, s.middle - alike, {}, &TriangleShape::middle);
         at != seen.end() && at->middle < s.middle + alike && cast < most_votes; ++at)
      if (std::abs(at->shortest - s.shortest) < alike) {
        ++votes[std::lround(std::log(at->longest / s.longest) / bin)];
        ++cast;
      }
  // A scale near a bin's edge votes for two.
  std::vector<std::pair<int, long>> ranked;
  for (const auto& [k, n] : votes) {
    const auto beside = votes.find(k + 1);
    ranked.push_back({-(n + (beside == votes.end() ? 0 : beside->second)), k});
  }
  std::ranges::sort(ranked);
  std::vector<double> out;
  for (const auto& [n, k] : ranked)
    if (out.size() < most) out.push_back(std::exp((static_cast<double>(k) + 0.5) * bin));
  return out;
}

}  // namespace gonio::reassembly
