// Edges at the vertices of a contour, slab by slab: threshold.h.
//
// From each vertex the profile is walked to twice the reach, inwards and outwards, for the next crossing of the value
// at which the contour stands. Where a wall comes nearer than five widths of the spread function, both are fitted
// together; where it stands further off, the profile ends where its smear begins.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "volume/edge_profiles.h"
#include "volume/slabs.h"

namespace gonio::volume {
namespace {

constexpr double smear = 2.5;     // widths: what a step still moves is a hundredth of it
constexpr double near_by = 0.75;  // voxels from the vertex that are not searched for another wall
constexpr double guessed_width = 0.8;
constexpr std::size_t scouts = 30000;  // vertices that tell what all share

// What a walk along the normal met: the profile's limits and the walls beyond which it has to be two edges.
struct Walk {
  double inward = std::numeric_limits<double>::infinity(), outward = std::numeric_limits<double>::infinity();
  double first = 0, last = 0;
  std::optional<double> inner{}, outer{};
};

// From the middle towards one end, distances of the first place where `inside` ends for a voxel, and of the next where
// it begins again. Crossings lie between samples.
struct Crossings {
  double next = std::numeric_limits<double>::infinity(), after = std::numeric_limits<double>::infinity();
};
Crossings crossings_along(const std::vector<double>& v, double step, double level, int direction) {
  const auto middle = static_cast<std::ptrdiff_t>(v.size() / 2), half = middle;
  const double sign = direction < 0 ? 1 : -1;  // inwards values lie above the level, outwards below
  Crossings found;
  const auto above = [&](std::ptrdiff_t n) {
    return sign * (v[static_cast<std::size_t>(middle + direction * n)] - level);
  };
  for (std::ptrdiff_t n = 1; n < half; ++n) {
    if (static_cast<double>(n) * step < near_by) continue;
    const double before = above(n - 1), here = above(n), beyond = above(n + 1);
    if (!std::isfinite(here) || !std::isfinite(beyond)) break;
    const bool searching = std::isinf(found.next);
    const bool crosses = searching ? here < 0 && beyond < 0 : here > 0 && beyond > 0;
    if (!crosses) continue;
    const double share = before * here < 0 ? before / (before - here) : 0;
    const double at = (static_cast<double>(n - 1) + share) * step;
    if (searching) {
      found.next = at;
    } else {
      found.after = at;
      break;
    }
  }
  return found;
}

// How far the profile reaches to one side: to the reach, short of the smear of a wall beyond, or past a wall that is
// fitted too.
double limit_of(const Crossings& c, double reach, double width, std::optional<double>& wall, double side) {
  if (c.next > 2 * smear * width) return std::min(reach, c.next - smear * width);
  wall = side * c.next;
  const double past = c.next + smear * width;
  return std::isinf(c.after) ? past : std::min(past, (c.next + c.after) / 2);
}

Walk walk_of(const std::vector<double>& values, double level, double reach, double step, double width) {
  Walk walk;
  const Crossings in = crossings_along(values, step, level, -1), out = crossings_along(values, step, level, 1);
  walk.inward = in.next;
  walk.outward = out.next;
  walk.first = -limit_of(in, reach, width, walk.inner, -1);
  walk.last = limit_of(out, reach, width, walk.outer, 1);
  return walk;
}

class Profiles {
 public:
  Profiles(const Contour& at, const EdgeWish& wish)
      : at_(at),
        wish_(wish),
        shapes_(at, wish.scale),
        half_(static_cast<std::size_t>(std::ceil(2 * wish.reach_voxels / wish.step_voxels))) {}
  std::size_t margin() const {
    const double reach = static_cast<double>(half_) * wish_.step_voxels + pool_radius;
    return static_cast<std::size_t>(std::ceil(reach / wish_.scale.z)) + 2;
  }

  EdgeProfile at(const Block& block, std::size_t vertex, double width) const {
    const LocalShape shape = shapes_.at(vertex);
    EdgeProfile profile{vertex, place_of(at_, vertex, wish_.scale), shape.mean_curvature(), shape.sharpest()};
    if (!is_finite(shape.normal)) return profile;
    profile.place.normal = shape.normal, profile.place.along = divided(shape.normal, wish_.scale);
    std::vector<double> values(2 * half_ + 1);
    const auto s = [&](std::size_t n) {
      return (static_cast<double>(n) - static_cast<double>(half_)) * wish_.step_voxels;
    };
    for (std::size_t n = 0; n < values.size(); ++n)
      values[n] = block.at(profile.place.index + profile.place.along * s(n));
    const Walk walk = walk_of(values, values[half_], wish_.reach_voxels, wish_.step_voxels, width);
    pool_voxels(block, shape, walk.first, walk.last, wish_.scale, wish_.noise_correlation, profile);
    profile.inward = walk.inward;
    profile.outward = walk.outward;
    profile.inner = walk.inner;
    profile.outer = walk.outer;
    return profile;
  }

 private:
  const Contour& at_;
  const EdgeWish& wish_;
  ContourShapes shapes_;
  std::size_t half_;
};

// Calls `body` with where in the order a vertex stands, for every n-th, slab by slab.
void stream(io::VolumeSource& source, const Contour& at, std::size_t margin, std::size_t every,
            const std::function<void(const Block&, std::size_t)>& body) {
  const auto& size = source.head().size;
  const std::size_t count = (at.positions.size() + every - 1) / every;
  std::vector<std::vector<std::uint32_t>> of_slice(size[2]);
  for (std::size_t n = 0; n < count; ++n) {
    const double k = at.positions[n * every][2];
    of_slice[static_cast<std::size_t>(std::clamp(k, 0.0, static_cast<double>(size[2] - 1)))].push_back(
        static_cast<std::uint32_t>(n));
  }
  SlabWish wish;
  wish.margin = margin;
  const Vec3 high{static_cast<double>(size[0] - 1), static_cast<double>(size[1] - 1), static_cast<double>(size[2] - 1)};
  for_each_slab(source, wish, [&](const Slab& slab) {
    const Block block{slab.values.data(),
                      {slab.width, slab.height, slab.count + 2 * slab.margin},
                      {0, 0, static_cast<std::ptrdiff_t>(slab.first) - static_cast<std::ptrdiff_t>(slab.margin)},
                      {},
                      high};
    std::vector<std::uint32_t> here;
    for (std::size_t k = slab.first; k < slab.first + slab.count; ++k)
      here.insert(here.end(), of_slice[k].begin(), of_slice[k].end());
    parallel_for(
        0, here.size(), [&](std::size_t n) { body(block, here[n]); }, 256);
  });
}

}  // namespace

std::vector<Edge> edges(io::VolumeSource& source, const Contour& at, const EdgeWish& wish, std::size_t every) {
  if (at.positions.empty())
    throw Error(Exit::data, "surface", "it is empty: no value of the volume lies on both sides of the threshold",
                "choose a threshold between two materials of the histogram");
  const Profiles profiles(at, wish);
  const std::size_t share = std::max<std::size_t>(1, at.positions.size() / scouts);
  std::vector<EdgeProfile> some((at.positions.size() + share - 1) / share);
  const double guess = wish.width.value_or(guessed_width);
  stream(source, at, profiles.margin(), share,
         [&](const Block& block, std::size_t n) { some[n] = profiles.at(block, n * share, guess); });
  const EdgeCommon common = common_of(some, wish);
  every = std::max<std::size_t>(1, every);
  std::vector<Edge> result((at.positions.size() + every - 1) / every);
  if (!(common.spread.across2 > 0)) return result;  // no scout saw an edge
  stream(source, at, profiles.margin(), every, [&](const Block& block, std::size_t n) {
    result[n] = fit_profile(profiles.at(block, n * every, std::sqrt(common.spread.across2)), wish, &common);
  });
  return result;
}

}  // namespace gonio::volume
