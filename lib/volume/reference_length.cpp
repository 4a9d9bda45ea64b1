// The threshold at which spheres of known radius have it: reference_length of threshold.h.
//
// Along each radius of each sphere the value falls from the object's to air's; where it crosses T is that direction's
// radius at T. Their mean over the directions, R(T), falls as T rises; R(T) = known radius is solved by bisection.
// Directions in which something else begins, or the value does not fall, are left out at every T alike.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "stats/intervals.h"
#include "volume/contour_shape.h"
#include "volume/markers_parts.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

using marker::Candidate;
using marker::Crop;

constexpr double ray_reach = 2.5, ray_step = 0.25;  // voxels

struct Ray {
  std::vector<double> values{};  // from the radius - reach to the radius + reach
};
struct Rays {
  std::vector<Ray> rays{};
  double low = 0, high = 0;  // air and object
};

// Radii whose ends have the values that most have: within a quarter of the step.
Rays rays_of(const ReferenceSphere& sphere, const Crop& crop, Vec3 scale) {
  Rays all;
  std::vector<double> first, last;
  const auto count = static_cast<std::size_t>(std::clamp(4 * pi * sphere.radius * sphere.radius / 2, 100.0, 2000.0));
  for (const Vec3 d : marker::even_directions(count)) {
    Ray ray;
    bool whole = true;
    for (double x = -ray_reach; x <= ray_reach + 1e-9; x += ray_step) {
      ray.values.push_back(crop.block.at(divided(sphere.centre * scale + d * (sphere.radius + x), scale)));
      whole = whole && std::isfinite(ray.values.back());
    }
    if (!whole) continue;
    first.push_back(ray.values.front()), last.push_back(ray.values.back());
    all.rays.push_back(std::move(ray));
  }
  if (all.rays.empty()) return all;
  all.high = stats::median(first);
  std::ranges::sort(last);
  all.low = last[last.size() / 5];
  const double slack = 0.25 * std::abs(all.high - all.low);
  std::erase_if(all.rays, [&](const Ray& r) {
    return std::abs(r.values.front() - all.high) > slack || std::abs(r.values.back() - all.low) > slack;
  });
  return all;
}

// R(T) - R_known: the length of each ray above T is where it crosses, whatever noise makes of the crossing itself.
double offset_at(const Rays& all, double threshold) {
  double sum = 0;
  for (const Ray& r : all.rays)
    for (std::size_t n = 0; n + 1 < r.values.size(); ++n) {
      const double a = r.values[n] - threshold, b = r.values[n + 1] - threshold;
      sum += ray_step * (a > 0 && b > 0 ? 1 : a <= 0 && b <= 0 ? 0 : a > 0 ? a / (a - b) : b / (b - a));
    }
  return sum / static_cast<double>(all.rays.size()) - ray_reach;
}

struct Solved {
  double threshold = 0, per_value = 0;  // dR / dT
};
std::optional<Solved> solved(const Rays& all) {
  constexpr std::size_t least_rays = 20;
  if (all.rays.size() < least_rays || !(all.high > all.low)) return {};
  const double step = all.high - all.low;
  double low = all.low + 0.05 * step, high = all.high - 0.05 * step;
  if (offset_at(all, low) < 0 || offset_at(all, high) > 0) return {};
  for (int n = 0; n < 50; ++n) {
    const double middle = (low + high) / 2;
    (offset_at(all, middle) > 0 ? low : high) = middle;
  }
  const double at = (low + high) / 2, d = 0.05 * step;
  return Solved{at, (offset_at(all, at + d) - offset_at(all, at - d)) / (2 * d)};
}

}  // namespace

Threshold reference_length(io::VolumeSource& source, std::span<const ReferenceSphere> spheres, Vec3 scale) {
  if (spheres.empty())
    throw Error(Exit::data, "threshold", "no reference sphere is given", "state centre and radius of one at least");
  std::vector<Candidate> boxes;
  for (const ReferenceSphere& s : spheres) boxes.push_back({s.centre * scale, s.radius});
  const std::vector<Crop> crops = marker::crops(source, boxes, scale);
  std::vector<double> values, slopes;
  double known = 0;
  for (std::size_t n = 0; n < spheres.size(); ++n)
    if (const auto s = solved(rays_of(spheres[n], crops[n], scale))) {
      values.push_back(s->threshold), slopes.push_back(s->per_value);
      const double each = spheres[n].sigma_radius / std::abs(s->per_value);
      known += each * each;
    }
  if (values.empty())
    throw Error(Exit::data, "threshold",
                "at no threshold has a reference sphere its radius (" + std::to_string(spheres.size()) + " asked)",
                "check radii, the size of a voxel, and that centres are indices");
  const double n = static_cast<double>(values.size());
  Threshold t;
  double squares = 0;
  for (std::size_t k = 0; k < values.size(); ++k) t.value += values[k] / n, t.voxels_per_value += slopes[k] / n;
  for (const double v : values) squares += (v - t.value) * (v - t.value);
  // Of the scatter and of the radii; one sphere alone has no scatter.
  const double scatter = values.size() > 1 ? std::sqrt(squares / (n - 1) / n) : 0;
  t.sigma = std::max(scatter, std::sqrt(known) / n);
  t.how = "reference length: radii of " + std::to_string(values.size()) + (values.size() == 1 ? " sphere" : " spheres");
  return t;
}

}  // namespace gonio::volume
