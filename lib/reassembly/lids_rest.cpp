// A linear programme in three unknowns by cutting planes: that of few gaps is solved by trying all corners, then the
// gap that it breaks most is added, until none is. Deterministic; each round only few gaps can still matter.
#include "reassembly/lids_rest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace gonio::reassembly {
namespace {

struct Plane {  // along . (s, tilt) <= limit
  Vec3 along;
  double limit = 0;
  std::optional<std::size_t> gap;  // which; none: a bound of the search
  double over(Vec3 x) const { return dot(along, x) - limit; }
};

std::optional<Vec3> corner_of(const Plane& a, const Plane& b, const Plane& c) {
  const double det = dot(a.along, cross(b.along, c.along));
  const double size = norm(a.along) * norm(b.along) * norm(c.along);
  if (!(std::abs(det) > 1e-12 * size)) return {};
  return (a.limit * cross(b.along, c.along) + b.limit * cross(c.along, a.along) + c.limit * cross(a.along, b.along)) /
         det;
}

struct Corner {
  Vec3 x;
  std::array<std::size_t, 3> planes{};
};
// The highest s of the corners that all planes allow.
std::optional<Corner> best_corner(const std::vector<Plane>& planes, double slack) {
  std::optional<Corner> best;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const auto x = corner_of(planes[i], planes[j], planes[k]);
        if (!x || (best && x->x <= best->x.x)) continue;
        if (std::ranges::all_of(planes, [&](const Plane& p) { return p.over(*x) <= slack; }))
          best = Corner{*x, {i, j, k}};
      }
  return best;
}

}  // namespace

Rest rest_on(std::span<const Gap> gaps, const RestLimits& limits) {
  const auto plane_of = [&](std::size_t k) {
    const Gap& g = gaps[k];
    return Plane{{1, g.normal.y * g.at.z + g.at.y, -(g.normal.x * g.at.z + g.at.x)}, g.gap - limits.clearance, k};
  };
  const std::vector<Plane> bounds{{{1, 0, 0}, limits.most_sinking, {}},
                                  {{0, 1, 0}, limits.most_tilt, {}},
                                  {{0, -1, 0}, limits.most_tilt, {}},
                                  {{0, 0, 1}, limits.most_tilt, {}},
                                  {{0, 0, -1}, limits.most_tilt, {}}};
  constexpr int most_rounds = 300;
  constexpr std::size_t most_planes = 24;
  const double slack = std::max(1e-3 * limits.clearance, 1e-12);
  std::vector<Plane> planes = bounds;
  std::optional<Corner> corner;
  for (int round = 0; round < most_rounds; ++round) {
    corner = best_corner(planes, slack / 2);
    if (!corner) break;
    double worst = slack;
    std::optional<std::size_t> broken;
    for (std::size_t k = 0; k < gaps.size(); ++k)
      if (const double over = plane_of(k).over(corner->x); over > worst) worst = over, broken = k;
    if (!broken) break;
    if (planes.size() >= most_planes) {
      std::vector<Plane> kept = bounds;
      for (const std::size_t i : corner->planes)
        if (planes[i].gap) kept.push_back(planes[i]);
      planes = std::move(kept);
    }
    planes.push_back(plane_of(*broken));
  }
  Rest rest;
  if (!corner) {
    rest.falls = true;
    return rest;
  }
  rest.sinking = corner->x.x;
  rest.tilt = {corner->x.y, corner->x.z};
  for (const std::size_t i : corner->planes)
    if (planes[i].gap)
      rest.feet.push_back(*planes[i].gap);
    else
      rest.falls = true;
  return rest;
}

}  // namespace gonio::reassembly
