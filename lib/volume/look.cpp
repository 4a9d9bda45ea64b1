// What a volume is like: look.h. The histogram tells materials, two of them which voxels surely are air or object, and
// those what noise, edges and artefacts are.
#include "volume/look.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "stats/intervals.h"
#include "volume/look_parts.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

constexpr std::size_t most_patches = 4000, fewest_patches = 20;
// Voxels below the surface: near the rim, yet clear of what the edge smears.
constexpr double rim_from = 3, rim_to = 5, deep_enough = 8;

void look_at_edges(const std::vector<PatchPoint>& patches, const Sides& sides, Look& look) {
  std::vector<double> widths;
  for (const PatchFit& fit : all_fitted(patches, sides, look.noise_air))
    if (fit.good) widths.push_back(fit.width);
  if (widths.size() < fewest_patches) return;
  const double median = stats::median(widths);
  std::vector<double> off;
  for (const double w : widths) off.push_back(std::abs(w - median));
  look.edge_width_voxels = median;
  // Of a median; patches that share voxels count half.
  look.sigma_edge_width =
      1.2533 * stats::sigma_of_median * stats::median(off) / std::sqrt(static_cast<double>(widths.size()) / 2);
}

// Of one material: near the rim against far inside.
double cupping_of(const CoarseField& field, const Sides& sides) {
  double deepest = 0;
  for (const float d : field.depth) deepest = std::max<double>(deepest, d);
  if (deepest < deep_enough) return 0;
  const double to = std::max(rim_to, rim_from + 1.5 * static_cast<double>(field.f));
  double rim = 0, rims = 0, inner = 0, inners = 0;
  for (std::size_t c = 0; c < field.depth.size(); ++c) {
    const double d = field.depth[c];
    if (d >= rim_from && d < to) rim += field.mean[c], ++rims;
    if (d >= 0.9 * deepest) inner += field.mean[c], ++inners;
  }
  return rims > 0 && inners > 0 ? (rim / rims - inner / inners) / sides.step() : 0;
}

// Beyond the circle that all views have seen, scanners store a constant: neither air nor free of noise.
void leave_out_padding(const Slab& slab, Flags& air) {
  const std::size_t w = slab.width, h = slab.height, slice = w * h;
  const double radius = static_cast<double>(std::min(w, h)) / 2 - 2;
  const std::vector<double> radii = radii_of_slice(slab);
  parallel_for(0, air.size() / slice, [&](std::size_t k) {
    for (std::size_t j = 0; j < h && (k * h + j + 1) * w < air.size(); ++j)
      for (std::size_t i = 0; i + 1 < w; ++i) {
        if (radii[j * w + i] < radius) continue;
        const std::size_t at = k * slice + j * w + i;
        const float* v = slab.values.data() + at;
        if (v[0] == v[1] || v[0] == v[w]) air[at] = 0;
      }
  });
}

}  // namespace

Look look(io::VolumeSource& source) {
  Look look;
  look.histogram = histogram(source);
  look.mixture = materials(look.histogram);
  if (look.mixture.materials.size() < 2) {
    look.otsu = look.mixture.materials.front().mean;
    return look;
  }
  look.otsu = otsu(look.histogram).value;
  const Sides sides = sides_of(look.mixture);
  const AirAndObject chosen = air_and_object(look.mixture);
  look.air = chosen.air, look.object = chosen.object;
  NoiseProbe noise;
  RingProbe rings;
  StreakProbe streaks;
  Thinned<PatchPoint> patches(most_patches);
  ProbeWish wish;
  wish.outside = static_cast<float>(sides.air);
  for_each_probe(source, wish, [&](const Slab& slab) {
    const std::vector<float> means = box_means(slab);
    Flags air(means.size()), object(means.size());
    parallel_for(
        0, means.size(),
        [&](std::size_t v) { air[v] = sides.surely_air(means[v]), object[v] = sides.surely_object(means[v]); },
        std::size_t{1} << 16);
    leave_out_padding(slab, air);
    noise.take(slab, air, object);
    take_patches(slab, sides, patches);
    air = eroded(slab, std::move(air), 4);
    object = eroded(slab, std::move(object), 3);
    rings.take(slab, air, object);
    streaks.take(slab, means, air, sides);
  });
  noise.finish(look);
  look_at_edges(patches.all(), sides, look);
  look.cupping = cupping_of(coarse_field(source, sides), sides);
  look.ring = look.noise_air > 0 ? std::sqrt(rings.variance()) / look.noise_air : 0;
  look.streak = streaks.sd() / sides.step();
  look.cut_voxels = voxels_at_the_border(source, sides);
  look.cut_by_field = look.cut_voxels > 0;
  return look;
}

}  // namespace gonio::volume
