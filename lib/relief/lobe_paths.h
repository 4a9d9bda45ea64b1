// Paths over a relief, one vertex after the other: what lobe.cpp's estimates are sums over.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "relief/lobe.h"

namespace gonio::relief {

inline constexpr int batches = 64;

// The frame of a facet, its tangent in the plane of the relief's x.
inline Basis facet_frame(Vec3 n) {
  return {n, normalized(Vec3{n.z, 0, -n.x})};
}

// Uniform in solid angle over the cone of the half angle whose cosine is given; the axis for 1.
inline Vec3 in_cone(const Basis& about, double cosine, double u, double v) {
  const double z = 1 - u * (1 - cosine), r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * pi * v;
  return about.to_world({r * std::cos(phi), r * std::sin(phi), z});
}

struct Path {
  Rgb throughput{1, 1, 1}, lost, cut;
  int facets = 0;
  bool delta = false;  // its last facet was a perfect mirror
  bool escaped = false;
  Vec3 leaves;
};

// `at_facet(hit, frame, wo_local, throughput)` before each reflection. Russian roulette beyond eight facets.
template <class AtFacet>
Path traced(const Relief& relief, const Material& material, Vec3 wo, Vec2 start, Random& random, int most_facets,
            const AtFacet& at_facet) {
  Path path;
  Vec3 direction = -wo;
  auto hit = relief.met_from_above(start.x * relief.width_m(), start.y * relief.length_m(), direction);
  while (hit) {
    const Basis frame = facet_frame(hit->normal);
    const Vec3 here = frame.to_local(-direction);
    if (here.z <= 0 || path.facets >= most_facets) {  // grazing by rounding
      path.cut = path.throughput;
      return path;
    }
    at_facet(*hit, frame, here, path.throughput);
    ++path.facets;
    const surface::Sample s =
        material.model->sample(material.values, here, {random.uniform(), random.uniform()}, random.uniform());
    const Rgb before = path.throughput;
    if (!(s.pdf > 0) || s.wi.z <= 0) {
      path.lost += before;
      path.throughput = {};
      return path;
    }
    path.throughput = before * s.weight;
    path.lost += before - path.throughput;
    if (path.facets > 8) {
      const double keep = std::min(0.95, max_component(path.throughput));
      if (random.uniform() >= keep) {
        path.throughput = {};
        return path;
      }
      path.throughput = path.throughput / keep;
    }
    path.delta = s.delta;
    direction = frame.to_world(s.wi);
    hit = relief.met_from(*hit, direction);
  }
  path.escaped = path.facets > 0;
  if (!path.escaped) path.cut = path.throughput;
  path.leaves = direction;
  return path;
}

// Every batch draws its starting places from a lattice of its own (Roberts 2018), turned by a random shift.
// batch(b, random, place): place(k) for its k-th path.
template <class Batch>
void run_batches(const Effort& effort, const Batch& batch) {
  parallel_for(0, batches, [&](std::size_t b) {
    Random random(effort.seed, b);
    const Vec2 shift{random.uniform(), random.uniform()};
    batch(b, random, [shift](std::int64_t k) {
      const double x = shift.x + static_cast<double>(k) * 0.7548776662466927,
                   y = shift.y + static_cast<double>(k) * 0.5698402909980532;
      return Vec2{x - std::floor(x), y - std::floor(y)};
    });
  });
}

inline Estimate estimate_of(const std::array<Rgb, batches>& means) {
  Rgb sum, squares;
  for (const Rgb& m : means) sum += m, squares += m * m;
  const Rgb mean = sum / batches, variance = (squares / batches - mean * mean) * (batches / (batches - 1.0)) / batches;
  return {mean,
          {std::sqrt(std::max(0.0, variance.x)), std::sqrt(std::max(0.0, variance.y)),
           std::sqrt(std::max(0.0, variance.z))}};
}

void check_lobe(const Relief& relief, Vec3 w, const char* name);

}  // namespace gonio::relief
