// surface.subsurface on cached geometry: the direct irradiance of a facet becomes that of where the light entered.
// Light between surfaces is not spread.
//
// Closed bodies (spheres, meshes): random walks within them (relighting/body_walks.h).
// What has a front alone (planes, open meshes) is taken for the face of a half space: the mean irradiance around a
// facet, weighted by the diffusion profile (surface/diffusion_profile.h). Rings of distance about every facet hold the
// mean irradiance from each lamp of points spread evenly over the surface, so that any mean free path costs one
// weighted sum a facet. The innermost ring is the facet's own light; rings without points give their weight to the
// others.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "relighting/body_walks.h"
#include "relighting/image_model.h"
#include "relighting/surface_samples.h"
#include "relighting/uses.h"
#include "surface/diffusion_profile.h"

namespace gonio::mechanism {
const Mechanism& surface_subsurface();
}

namespace gonio::relighting::terms {
namespace {

// Outer radii of the rings, m: from half a millimetre by half octaves.
constexpr std::size_t rings = 15;
constexpr double first_ring_m = 0.0005;
double outer(std::size_t ring) {
  return first_ring_m * std::pow(2.0, 0.5 * static_cast<double>(ring));
}
constexpr double pairs = 3e8;  // of facets and points: what bounds the points
constexpr std::size_t most_points = 60000, least_points = 4000;

constexpr std::size_t walks = 384, walks_of_pictures = 64;

struct Bodies final : Prepared {
  Bodies(const Setting& s, std::size_t surface, std::size_t count) : light(s, surface, count) {}
  BodyWalks light;
};

struct Rings final : Prepared {
  std::vector<std::vector<float>> mean;         // [view][facet][light][ring]
  std::vector<std::vector<std::uint8_t>> seen;  // [view][facet][ring]: has points
};

void gather(const Vec3& at, const SurfaceSamples& samples, std::size_t lights, float* mean, std::uint8_t* seen) {
  static const double reach2 = outer(rings - 1) * outer(rings - 1);
  std::array<double, rings> n{};
  std::vector<double> sum(lights * rings);
  for (std::size_t i = 0; i < samples.position_m.size(); ++i) {
    const Vec3 d = samples.position_m[i] - at;
    const double square = dot(d, d);
    if (square >= reach2) continue;
    const double octaves = std::log2(square / (first_ring_m * first_ring_m));
    const auto ring = static_cast<std::size_t>(std::max(0.0, std::floor(octaves) + 1));
    n[ring] += 1;
    for (std::size_t l = 0; l < lights; ++l) sum[l * rings + ring] += samples.irradiance[i * lights + l];
  }
  for (std::size_t r = 0; r < rings; ++r) {
    seen[r] = n[r] > 0;
    for (std::size_t l = 0; l < lights; ++l)
      mean[l * rings + r] = static_cast<float>(n[r] > 0 ? sum[l * rings + r] / n[r] : 0);
  }
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  const std::size_t surface = use.targets[0], lights = s.layout.lights.size();
  if (are_bodies(s, surface)) return std::make_shared<Bodies>(s, surface, s.fitted ? walks_of_pictures : walks);
  Vec3 lower{1e30, 1e30, 1e30}, upper = -lower;
  std::size_t facets = 0;
  for (std::size_t v = 0; v < s.model.views(); ++v)
    for (const Facet& f : s.model.cache(v).facets) {
      if (f.surface != surface) continue;
      ++facets;
      const Vec3 p = s.model.cache(v).patches[f.first_patch].position_m;
      lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
      upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
    }
  const double margin = outer(rings - 1);
  const auto points =
      std::clamp(static_cast<std::size_t>(pairs / static_cast<double>(std::max<std::size_t>(1, facets))), least_points,
                 most_points);
  const SurfaceSamples samples =
      surface_samples(s, surface, lower - Vec3{margin, margin, margin}, upper + Vec3{margin, margin, margin}, points);
  auto result = std::make_shared<Rings>();
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    result->mean.emplace_back(cache.facets.size() * lights * rings);
    result->seen.emplace_back(cache.facets.size() * rings);
    parallel_for(
        0, cache.facets.size(),
        [&](std::size_t f) {
          if (cache.facets[f].surface != surface) return;
          gather(cache.patches[cache.facets[f].first_patch].position_m, samples, lights,
                 &result->mean[v][f * lights * rings], &result->seen[v][f * rings]);
        },
        32);
  }
  return result;
}

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses;
  for (std::size_t k = 0; k < s.layout.surfaces.size(); ++k) {
    const SurfaceState& surface = s.layout.start.surfaces[k];
    if (!has_parameter(*surface.model, "albedo") ||
        switched_on(s.document, mechanism::surface_subsurface().id, s.layout.surfaces[k]))
      continue;
    uses.push_back(target_use(mechanism::surface_subsurface(), {s.layout.surfaces[k]}, {k}, false));
  }
  return uses;
}

using RingWeights = std::array<Rgb, rings>;

RingWeights ring_weights(std::span<const double> paths_m, Rgb albedo) {
  RingWeights weights;
  Rgb before;
  for (std::size_t r = 0; r < rings; ++r) {
    Rgb within;
    for (int c = 0; c < 3; ++c) {
      const double share =
          surface::diffusion_within(outer(r), paths_m[static_cast<std::size_t>(c)], std::clamp(albedo[c], 0.0, 1.0));
      (c == 0 ? within.x : c == 1 ? within.y : within.z) = share;
    }
    weights[r] = within - before;
    before = within;
  }
  return weights;
}

// Calls change(view, facet, light, own) for every facet of the surface under every light of the image: what is added to
// the irradiance, per unit of intensity.
template <class Change>
void change_irradiance(const Use& use, const Frame& frame, Shading& shading, const Change& change) {
  const std::size_t view = frame.image.view;
  std::size_t slot = 0;
  for (const std::uint32_t p : frame.picked)
    for (std::size_t k = 0; k < frame.cache.pixels[p].facets; ++k, ++slot) {
      const std::size_t f = frame.cache.pixels[p].first_facet + k;
      if (frame.cache.facets[f].surface != use.targets[0]) continue;
      for (std::size_t j = 0; j < shading.lights; ++j) {
        const std::size_t l = frame.image.lights[j];
        shading.direct[slot * shading.lights + j].base +=
            change(view, f, l, frame.model.small_light(view, f, l)) * (frame.cache.facets[f].weight / pi);
      }
    }
}

void shade(const Use& use, const Frame& frame, Shading& shading) {
  const SurfaceState& surface = frame.state.surfaces[use.targets[0]];
  const Rgb albedo = surface.values.rgb(parameter_index(*surface.model, "albedo"));
  const std::span<const double> paths_m = use.amounts(frame.state);
  if (const auto* bodies = dynamic_cast<const Bodies*>(use.prepared.get())) {
    const BodyWalks& light = bodies->light;
    const BodyWalks::Weights w[3] = {light.weights(paths_m[0], albedo.x), light.weights(paths_m[1], albedo.y),
                                     light.weights(paths_m[2], albedo.z)};
    change_irradiance(use, frame, shading, [&](std::size_t view, std::size_t f, std::size_t l, double own) {
      return Rgb{light.spread(w[0], view, f, l, own) - own, light.spread(w[1], view, f, l, own) - own,
                 light.spread(w[2], view, f, l, own) - own};
    });
    return;
  }
  const auto& table = static_cast<const Rings&>(*use.prepared);
  const std::size_t lights = frame.model.layout().lights.size();
  const RingWeights weights = ring_weights(paths_m, albedo);
  change_irradiance(use, frame, shading, [&](std::size_t view, std::size_t f, std::size_t l, double own) {
    const float* mean = &table.mean[view][(f * lights + l) * rings];
    Rgb change, total = weights[0];
    for (std::size_t r = 1; r < rings; ++r) {
      if (!table.seen[view][f * rings + r]) continue;
      change += weights[r] * (double{mean[r]} - own);
      total += weights[r];
    }
    return Rgb{change.x / total.x, change.y / total.y, change.z / total.z};
  });
}

}  // namespace

const Term& surface_subsurface() {
  static const Term term{
      .mechanism = mechanism::surface_subsurface,
      .reach = Reach::shade,
      .candidates = candidates,
      .prepare = prepare,
      .shade = shade,
  };
  return term;
}

}  // namespace gonio::relighting::terms
