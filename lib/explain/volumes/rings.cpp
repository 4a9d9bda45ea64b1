// Rings: the fine structure in the radius that the same ring shows elsewhere in its slice. See sites.h.
//
// Gains of pixels are told by their neighbours least of all, and the ramp filter lifts what alternates from pixel to
// pixel: a ring is one pixel wide. It is therefore looked for at the very radius and height of a place, as the place
// itself is read, along two arcs of its circle to either side. From each value there the mean of those farther in and
// farther out is taken, as far as they lie in the same matter. A scan over half a turn draws half rings: the
// arcs end a quarter of a turn away, less where the other half begins than they lose to noise.
//
// What both arcs show alike is ring, what they differ by is noise: with the means a and b of the two, pooled over
// places of about the same radius, S = <a b> and N = <(a - b)^2> / 4, the ring at a place is best told by S / (S + N)
// times their mean (Wiener). No place has a part in what it is held against.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "explain/volumes/sites.h"

namespace gonio::explain::volumes {
namespace {

constexpr double nearest_voxels = 3.5, farthest_rad = 75 * pi / 180, step_voxels = 1.2;
constexpr int most_steps = 40;
constexpr int plain_voxels = 7, from_wall = 2, first_around = 2, last_around = 5, fewest_around = 3;
constexpr std::size_t pooled = 300;

struct Arc {
  double sum = 0, count = 0;
  double mean() const { return sum / count; }
};

class Circles {
 public:
  Circles(const Sampled& sampled, const Body& body, const Values& values)
      : sampled_(sampled), body_(body), values_(values) {}

  // The arc to one side of a place.
  Arc arc(Vec3 at_m, int side) const {
    const double voxel = sampled_.voxel_m(), radius = std::hypot(at_m.x, at_m.y);
    const double own = std::atan2(at_m.y, at_m.x), nearest = nearest_voxels * voxel / (2 * radius);
    Arc arc;
    if (!(nearest < 0.5)) return arc;
    const double first = 2 * std::asin(nearest);
    const double step = std::max(step_voxels * voxel / radius, (farthest_rad - first) / most_steps);
    for (double angle = first; angle < farthest_rad; angle += step)
      add({std::cos(own + side * angle), std::sin(own + side * angle), 0}, radius, at_m.z, arc);
    return arc;
  }

 private:
  double share(Vec3 outward, double radius, double z) const { return body_.at(outward * radius + Vec3{0, 0, z}); }
  double value(Vec3 outward, double radius, double z) const {
    return (sampled_.at(outward * radius + Vec3{0, 0, z}) - values_.air) / (values_.material - values_.air);
  }
  void add(Vec3 outward, double radius, double z, Arc& into) const {
    const double own = share(outward, radius, z), voxel = sampled_.voxel_m();
    if (own > 0.001 && own < 0.999) return;
    double around = 0, count = 0;
    for (const int way : {-1, 1}) {
      int same = 0;  // voxels that way in the same matter
      while (same < plain_voxels && radius + way * (same + 1) * voxel > 0 &&
             std::abs(share(outward, radius + way * (same + 1) * voxel, z) - own) < 0.001)
        ++same;
      if (same < from_wall) return;
      for (int d = first_around; d <= std::min(last_around, same - from_wall); ++d) {
        const double v = value(outward, radius + way * d * voxel, z);
        if (std::isfinite(v)) around += v, count += 1;
      }
    }
    const double v = value(outward, radius, z);
    if (count < fewest_around || !std::isfinite(v)) return;
    into.sum += v - around / count, into.count += 1;
  }
  const Sampled& sampled_;
  const Body& body_;
  const Values& values_;
};

struct Pool {  // sums over places whose radii are about the same
  double like = 0, unlike = 0, count = 0;
  void add(const Pool& p, double sign) { like += sign * p.like, unlike += sign * p.unlike, count += sign * p.count; }
};

}  // namespace

double add_rings(const Sampled& sampled, const Body& body, const Values& values, std::vector<Row>& rows) {
  std::vector<std::size_t> greys;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (is_grey(rows[i].reading)) greys.push_back(i);
  const auto radius = [&](std::size_t i) { return std::hypot(rows[i].at_m.x, rows[i].at_m.y); };
  std::ranges::stable_sort(greys, {}, radius);
  const Circles circles(sampled, body, values);
  std::vector<std::array<Arc, 2>> arcs(greys.size());
  std::vector<Pool> pools(greys.size());
  parallel_for(
      0, greys.size(),
      [&](std::size_t n) {
        const Vec3 at = rows[greys[n]].at_m;
        arcs[n] = {circles.arc(at, -1), circles.arc(at, 1)};
        const auto& [a, b] = arcs[n];
        if (a.count > 0 && b.count > 0)
          pools[n] = {a.mean() * b.mean(), 0.25 * (a.mean() - b.mean()) * (a.mean() - b.mean()), 1};
      },
      16);
  Pool pool;
  double squares = 0;
  std::size_t next = 0;
  for (std::size_t n = 0; n < greys.size(); ++n) {
    for (; next < std::min(greys.size(), n + pooled / 2); ++next) pool.add(pools[next], 1);
    if (n > pooled / 2) pool.add(pools[n - pooled / 2 - 1], -1);
    const auto& [a, b] = arcs[n];
    if (!(a.count + b.count > 0) || pool.count < 0.1 * pooled) continue;
    const double noise = pool.unlike * (a.count > 0 && b.count > 0 ? 1 : 2), like = std::max(0.0, pool.like);
    if (like + noise > 0) rows[greys[n]].ring = like / (like + noise) * (a.sum + b.sum) / (a.count + b.count);
    squares += rows[greys[n]].ring * rows[greys[n]].ring;
  }
  const double rms = greys.empty() ? 0 : std::sqrt(squares / static_cast<double>(greys.size()));
  if (rms > 0)
    for (Row& row : rows) row.ring /= rms;
  return rms;
}

}  // namespace gonio::explain::volumes
