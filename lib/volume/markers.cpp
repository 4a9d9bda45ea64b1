// Markers among the spheres of a surface: markers.h. What each sphere shows for itself, then what they show together.
#include "volume/markers.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "linear/symmetric_eigen.h"
#include "stats/intervals.h"
#include "volume/contour_shape.h"
#include "volume/markers_parts.h"

namespace gonio::volume {
namespace marker {
namespace {

constexpr double same_value = 0.15;  // of the step from air: values that agree so well are of one material
constexpr double own_share = 0.06;   // of the directions: a sphere that goes on into its like so far grew there
constexpr double least_flatness = 0.12;

// Least eigenvalue of the mean of d d' over the directions with an edge.
double flatness_of(const Sphere& s) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (const RadialEdge& e : s.edges) {
    const Eigen::Vector3d d(e.direction.x, e.direction.y, e.direction.z);
    m += d * d.transpose() / static_cast<double>(s.edges.size());
  }
  return linear::SymmetricEigen<Eigen::Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

}  // namespace

Evidence evidence(const Sphere& s, const Crop& crop, Vec3 scale) {
  Evidence e;
  std::vector<double> without, shell, core;
  const double width = s.edges.empty() ? 0.85 : s.width, depth = std::max(0.45 * s.radius, s.radius - 2.2 * width - 1);
  const auto at = [&](Vec3 d, double r) { return crop.block.at(divided(s.centre + d * r, scale)); };
  for (std::size_t n = 0; n < s.asked.size(); ++n) {
    if (const double v = at(s.asked[n], s.radius + 2.5); std::isfinite(v)) without.push_back(v);
    for (double r = 0; r < depth; r += depth / 12) {
      const double v = at(s.asked[n], r);
      if (!std::isfinite(v)) continue;
      if (n % 4 == 0 && r < 0.4 * s.radius) core.push_back(v);
      if (r > 0.7 * depth) shell.push_back(v);
    }
  }
  std::ranges::sort(without);
  if (!without.empty()) e.air = without[without.size() / 5];  // air is what lies lowest round it
  e.within = stats::median(shell);
  e.centre = stats::median(core);
  e.flatness = s.edges.empty() ? 0 : flatness_of(s);
  return e;
}

double grown_share(const Sphere& s, const Evidence& e, const Crop& crop, Vec3 scale,
                   const std::vector<Candidate>& others) {
  const double slack = same_value * (e.within - e.air) + 2.5 * s.noise;
  std::size_t like = 0;
  for (std::size_t n = 0; n < s.asked.size(); ++n) {
    if (s.covered[n]) continue;
    const Vec3 beyond = s.centre + s.asked[n] * (s.radius + 2);
    if (std::ranges::any_of(others, [&](const Candidate& o) { return norm(o.centre - beyond) < o.radius + 1; }))
      continue;
    // No step where the sphere's surface would be, however thin what follows, and nothing denser behind: between air
    // and something denser a smeared wall has any value.
    bool goes_on = true;
    for (double x = 1.3; x <= 3; x += 0.5)
      goes_on = goes_on && !(crop.block.at(divided(s.centre + s.asked[n] * (s.radius + x), scale)) > e.within + slack);
    for (double x = -1.2; x <= 0.9; x += 0.5)
      goes_on =
          goes_on && std::abs(crop.block.at(divided(s.centre + s.asked[n] * (s.radius + x), scale)) - e.within) < slack;
    like += goes_on ? 1 : 0;
  }
  return static_cast<double>(like) / static_cast<double>(std::max<std::size_t>(1, s.asked.size()));
}

std::string reason_against(const Sphere& s, const Evidence& e, const MarkerWish& wish) {
  if (std::abs(e.centre - e.within) > 0.4 * std::abs(e.within - e.air))
    return format("is hollow: %.4g in the middle, %.4g beneath the surface", e.centre, e.within);
  if (s.edges.size() < 12) return format("shows an edge in %zu directions only (limit 12)", s.edges.size());
  if (wish.radius && std::abs(s.radius - *wish.radius) > wish.radius_tolerance * *wish.radius)
    return format("radius %.2f is not the known %.2f within %.0f %%", s.radius, *wish.radius,
                  100 * wish.radius_tolerance);
  const double slack = std::max(3 * s.sigma_radius, 0.02 * s.radius);
  if (!wish.radius && (s.radius < wish.smallest - slack || s.radius > wish.largest + slack))
    return format("radius %.2f is not within %.2f to %.2f", s.radius, wish.smallest, wish.largest);
  if (s.cover() < wish.least_cover)
    return format("covers %.2f of the directions (limit %.2f)", s.cover(), wish.least_cover);
  if (e.flatness < least_flatness)
    return format("edges lie round a belt (least moment %.2f, limit %.2f): a tube or a ring", e.flatness,
                  least_flatness);
  const double limit = std::max(0.25, 0.02 * s.radius) + 0.5 * s.edges[s.edges.size() / 2].sigma;
  if (s.rms > limit) return format("is not round: edges are off by %.2f voxel rms (limit %.2f)", s.rms, limit);
  return {};
}

}  // namespace marker

namespace {

using marker::Candidate;
using marker::Crop;
using marker::Evidence;
using marker::Sphere;

struct Judged {
  Sphere sphere;
  Evidence evidence;
  std::string why{};
};

bool grew(const Judged& j) {
  return j.evidence.grown > marker::own_share;
}

// Candidates from different cells may have come to rest in one place.
constexpr const char* repeated = "the same again";
void drop_repeated(std::vector<Judged>& all) {
  for (std::size_t n = 0; n < all.size(); ++n)
    for (std::size_t o = 0; o < n; ++o) {
      const Sphere &a = all[n].sphere, &b = all[o].sphere;
      if (all[o].why != repeated && norm(a.centre - b.centre) < 0.5 * std::min(a.radius, b.radius)) {
        Judged& worse = a.cover() > b.cover() && !all[o].why.empty() ? all[o] : all[n];
        worse.why = repeated;
      }
    }
}
// Of what nobody would take for a sphere nobody wants to read.
bool worth_a_word(const Judged& j, const MarkerWish& wish) {
  return j.why != repeated && (j.sphere.cover() > 0.6 * wish.least_cover || j.why.starts_with("is hollow"));
}

// Spheres that go on into their like are the object's own (knobs, rounded ends), if there are others that do not. Where
// all do, the object is of the markers' material, and their radius has to tell: the known one, or one that two share.
void judge_together(std::vector<Judged>& all, const MarkerWish& wish) {
  std::size_t free_standing = 0;
  for (const Judged& j : all) free_standing += j.why.empty() && !grew(j) ? 1 : 0;
  for (Judged& j : all) {
    if (!j.why.empty() || !grew(j)) continue;
    const std::string grown = format("goes on into what it sits on with its own value %.4g over %.2f of the directions",
                                     j.evidence.within, j.evidence.grown);
    if (free_standing > 0) {
      j.why = grown + ": part of the object";
      continue;
    }
    std::size_t alike = 0;
    for (const Judged& o : all)
      alike += (o.why.empty() || &o == &j) && grew(o) && std::abs(o.sphere.radius / j.sphere.radius - 1) < 0.05 ? 1 : 0;
    if (!wish.radius && alike < 2) j.why = grown + ", and no other sphere has its radius: a knob, or state the radius";
  }
}

// A known radius is held where the free ones agree with it: together within three of their errors, and a two hundredth.
std::optional<double> held_radius(const std::vector<Judged>& all, const MarkerWish& wish) {
  if (!wish.radius) return {};
  double sum = 0, weight = 0;
  for (const Judged& j : all)
    if (j.why.empty() && j.sphere.sigma_radius > 0) {
      const double w = 1 / (j.sphere.sigma_radius * j.sphere.sigma_radius);
      sum += w * j.sphere.radius, weight += w;
    }
  if (!(weight > 0)) return {};
  const double off = std::abs(sum / weight - *wish.radius);
  return off < 3 / std::sqrt(weight) + 0.005 * *wish.radius ? wish.radius : std::nullopt;
}

Marker stated(const Judged& j, Vec3 scale) {
  Marker m;
  const Sphere& s = j.sphere;
  m.centre = divided(s.centre, scale);
  m.radius = s.radius;
  m.sigma_radius = s.sigma_radius;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const auto at = static_cast<std::size_t>(3 * a + b);
      m.covariance[at] = s.covariance[at] / (scale[a] * scale[b]);
    }
  m.rms_residual = s.rms;
  m.cover = s.cover();
  m.mean_value = j.evidence.within;
  m.edges = s.edges.size();
  return m;
}

void demand(const Contour& surface, double threshold, const MarkerWish& wish) {
  if (surface.positions.empty())
    throw Error(Exit::data, "markers",
                format("no surface at the threshold %.6g: every value lies on one side of it", threshold),
                "choose a threshold between air and the markers");
  const double least = std::min({wish.scale.x, wish.scale.y, wish.scale.z});
  if (!(least > 0) || !(wish.smallest > 0) || !(wish.largest > wish.smallest) || (wish.radius && !(*wish.radius > 1.5)))
    throw Error(Exit::data, "markers",
                wish.radius ? format("a radius of %.3g voxels is none that can be seen (limit 1.5)", *wish.radius)
                            : format("radii from %.3g to %.3g voxels are no range", wish.smallest, wish.largest),
                "state the markers' radius as a length, and the size of a voxel");
}

}  // namespace

Markers markers(io::VolumeSource& source, const Contour& surface, double threshold, const MarkerWish& wish) {
  demand(surface, threshold, wish);
  const marker::Cloud cloud(surface, wish.scale);
  std::vector<Candidate> spheres = marker::candidates(cloud, wish);
  Markers result;
  std::erase_if(spheres, [&](const Candidate& c) {
    if (c.radius > 0) return false;
    result.refused.push_back({divided(c.centre, wish.scale), -c.radius, "is a bubble: values rise outwards"});
    return true;
  });
  const std::vector<Crop> crops = marker::crops(source, spheres, wish.scale);
  std::vector<Judged> all(spheres.size());
  const auto refine = [&](const marker::NoiseModel& noise, std::optional<double> radius) {
    for (std::size_t n = 0; n < all.size(); ++n)
      if (all[n].why.empty()) all[n].sphere = marker::refined(spheres[n], crops[n], noise, wish.scale, radius);
  };
  refine(marker::noise_within(spheres, crops, wish, {}), {});
  for (std::size_t n = 0; n < spheres.size(); ++n) {
    all[n].evidence = marker::evidence(all[n].sphere, crops[n], wish.scale);
    all[n].why = marker::reason_against(all[n].sphere, all[n].evidence, wish);
  }
  drop_repeated(all);
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (!all[n].why.empty()) continue;
    std::vector<Candidate> others;
    for (std::size_t o = 0; o < all.size(); ++o)
      if (o != n && all[o].why.empty()) others.push_back({all[o].sphere.centre, all[o].sphere.radius});
    all[n].evidence.grown = marker::grown_share(all[n].sphere, all[n].evidence, crops[n], wish.scale, others);
  }
  judge_together(all, wish);
  // The noise of what turned out to be markers, and their radius if it is the known one.
  std::vector<bool> kept;
  for (std::size_t n = 0; n < all.size(); ++n) {
    kept.push_back(all[n].why.empty());
    if (kept[n]) spheres[n] = {all[n].sphere.centre, all[n].sphere.radius};
  }
  const marker::NoiseModel noise = marker::noise_within(spheres, crops, wish, kept);
  refine(noise, {});
  if (const auto radius = held_radius(all, wish)) refine(noise, radius);
  for (const Judged& j : all)
    if (j.why.empty())
      result.found.push_back(stated(j, wish.scale));
    else if (worth_a_word(j, wish))
      result.refused.push_back({divided(j.sphere.centre, wish.scale), j.sphere.radius, j.why});
  const auto order = [](const auto& a, const auto& b) {
    return std::array{a.centre.z, a.centre.y, a.centre.x} < std::array{b.centre.z, b.centre.y, b.centre.x};
  };
  std::ranges::sort(result.found, order);
  std::ranges::sort(result.refused, order);
  return result;
}

}  // namespace gonio::volume
