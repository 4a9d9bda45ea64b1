// Edges at the vertices of a contour, slab by slab: threshold.h.
//
// From each vertex the profile is walked to twice the reach, inwards and outwards, for the next crossing of the value
// at which the contour stands. Where a wall comes nearer than five widths of the spread function, both are fitted
// together; where it stands further off, the profile ends where its smear begins.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "volume/contour_shape.h"
#include "volume/sampling.h"
#include "volume/slabs.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

constexpr double smear = 2.5;              // widths: what a step still moves is a hundredth of it
constexpr double near_by = 0.75;           // voxels from the vertex that are not searched for another wall
constexpr double sharpest_curvature = 0.35;
constexpr std::size_t scouts = 4000;       // vertices that tell the width and the noise

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
  const auto above = [&](std::ptrdiff_t n) { return sign * (v[static_cast<std::size_t>(middle + direction * n)] - level); };
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
      : at_(at), wish_(wish), curvature_(mean_curvature(at, wish.scale)) {
    half_ = static_cast<std::size_t>(std::ceil(2 * wish.reach_voxels / wish.step_voxels));
    for (float& h : curvature_) h = std::clamp(h, -static_cast<float>(sharpest_curvature), static_cast<float>(sharpest_curvature));
  }
  double reach() const { return static_cast<double>(half_) * wish_.step_voxels; }
  EdgeWish& wish() { return wish_; }

  Edge edge_at(const Block& block, std::size_t vertex) const {
    const Place place = place_of(at_, vertex, wish_.scale);
    std::vector<double> s(2 * half_ + 1), values(s.size());
    for (std::size_t n = 0; n < s.size(); ++n) {
      s[n] = (static_cast<double>(n) - static_cast<double>(half_)) * wish_.step_voxels;
      values[n] = block.at(place.index + place.along * s[n]);
    }
    const double width = wish_.width.value_or(0.8);
    const Walk walk = walk_of(values, values[half_], wish_.reach_voxels, wish_.step_voxels, width);
    std::size_t first = 0, last = s.size();
    while (first < half_ && (s[first] < walk.first - 1e-9 || !std::isfinite(values[first]))) ++first;
    while (last > half_ + 1 && (s[last - 1] > walk.last + 1e-9 || !std::isfinite(values[last - 1]))) --last;
    const std::size_t n = last - first;
    const std::vector<double> covariance =
        trilinear_covariance(place.index + place.along * s[first], place.along * wish_.step_voxels, n,
                             wish_.noise_correlation);
    ProfileWish profile{wish_.noise, covariance, curvature_[vertex], walk.inner, walk.outer, wish_.width};
    Edge edge = fit_edge(std::span(s).subspan(first, n), std::span(values).subspan(first, n), profile);
    edge.inward = walk.inward;
    edge.outward = walk.outward;
    return edge;
  }

 private:
  const Contour& at_;
  EdgeWish wish_;
  std::vector<float> curvature_;
  std::size_t half_ = 0;
};

// Edges of every n-th vertex, each where its vertex stands in the order.
std::vector<Edge> streamed(io::VolumeSource& source, const Contour& at, const Profiles& profiles, Vec3 scale,
                           double reach, std::size_t every) {
  const auto& size = source.head().size;
  const std::size_t count = (at.positions.size() + every - 1) / every;
  std::vector<std::vector<std::size_t>> of_slice(size[2]);
  for (std::size_t n = 0; n < count; ++n) {
    const double k = at.positions[n * every][2];
    of_slice[static_cast<std::size_t>(std::clamp(k, 0.0, static_cast<double>(size[2] - 1)))].push_back(n);
  }
  std::vector<Edge> result(count);
  SlabWish wish;
  wish.margin = static_cast<std::size_t>(std::ceil(reach / scale.z)) + 2;
  const Vec3 high{static_cast<double>(size[0] - 1), static_cast<double>(size[1] - 1), static_cast<double>(size[2] - 1)};
  for_each_slab(source, wish, [&](const Slab& slab) {
    Block block{slab.values.data(), {slab.width, slab.height, slab.count + 2 * slab.margin},
                {0, 0, static_cast<std::ptrdiff_t>(slab.first) - static_cast<std::ptrdiff_t>(slab.margin)}, {}, high};
    std::vector<std::size_t> here;
    for (std::size_t k = slab.first; k < slab.first + slab.count; ++k)
      here.insert(here.end(), of_slice[k].begin(), of_slice[k].end());
    parallel_for(0, here.size(), [&](std::size_t n) { result[here[n]] = profiles.edge_at(block, here[n] * every); }, 256);
  });
  return result;
}

double median_of(std::vector<double> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

// Width and noise from some vertices: of edges that stand alone where there are enough, else of all.
void scout(const std::vector<Edge>& edges, EdgeWish& wish) {
  std::vector<double> alone, all, noise;
  for (const Edge& e : edges) {
    if (!e.good) continue;
    all.push_back(e.width);
    if (std::min(e.inward, e.outward) > 2 * smear * e.width) alone.push_back(e.width);
    noise.push_back(e.excess);
  }
  if (all.empty()) return;
  if (!wish.width) wish.width = median_of(alone.size() >= 50 ? alone : all);
  // The median of chi-square with the few degrees that a profile leaves is 0.85 of its mean.
  if (!(wish.noise > 0)) wish.noise = std::sqrt(median_of(noise) / 0.85);
}

}  // namespace

std::vector<Edge> edges(io::VolumeSource& source, const Contour& at, const EdgeWish& wish, std::size_t every) {
  if (at.positions.empty())
    throw Error(Exit::data, "surface", "it is empty: no value of the volume lies on both sides of the threshold",
                "choose a threshold between two materials of the histogram");
  Profiles profiles(at, wish);
  if (!wish.width || !(wish.noise > 0)) {
    const std::size_t share = std::max<std::size_t>(1, at.positions.size() / scouts);
    scout(streamed(source, at, profiles, wish.scale, profiles.reach(), share), profiles.wish());
  }
  return streamed(source, at, profiles, wish.scale, profiles.reach(), std::max<std::size_t>(1, every));
}

}  // namespace gonio::volume
