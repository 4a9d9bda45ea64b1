#include "relighting/rings.h"

#include <algorithm>

#include "relighting/recast.h"

namespace gonio::relighting {
namespace {

constexpr int few = 4, many = 8;  // sub-samples a side: where nothing changes within the ring, and elsewhere
constexpr double even = 0.01;     // relative error of a ring's light with few, up to which they suffice

// Does the ring show one surface, evenly lit?
bool plain(const ViewCache& cache, const std::vector<float>& sums, const Pixel& pixel, std::size_t lights) {
  if (pixel.facets == 0) return true;
  if (pixel.facets > 1 || pixel.sky > 0) return false;
  const std::size_t f = pixel.first_facet;
  for (std::size_t l = 0; l < lights; ++l) {
    const double light = sums[(f * lights + l) * radii_m.size()], share = cache.direct_sigma[f * lights + l];
    const float visible = cache.visible[cache.facets[f].first_patch * lights + l];
    if (share > even * light && visible > 0) return false;
  }
  return true;
}

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

// Adds the facets of `more` to the cache's, without its pixels.
void append_facets(const ViewCache& more, ViewCache& cache) {
  const auto patches = static_cast<std::uint32_t>(cache.patches.size());
  for (Facet f : more.facets) {
    f.first_patch += patches;
    cache.facets.push_back(f);
  }
  append(more.patches, cache.patches);
  append(more.direct, cache.direct);
  append(more.visible, cache.visible);
  append(more.indirect, cache.indirect);
  append(more.mirrored, cache.mirrored);
  append(more.lit, cache.lit);
  append(more.indirect_sigma, cache.indirect_sigma);
  append(more.direct_sigma, cache.direct_sigma);
  append(more.margin, cache.margin);
}

// Facets become pixels.
void split(const Rigid<frame::World, frame::Camera>& world_from_camera, Ring& ring) {
  const auto camera_from_world = inverse(world_from_camera);
  std::vector<Pixel> parts;
  for (const Pixel& p : ring.parts.pixels) {
    ring.first.push_back(static_cast<std::uint32_t>(parts.size()));
    ring.sky.push_back(p.sky);
    for (std::uint32_t k = 0; k < p.facets; ++k) parts.push_back({p.x, p.y, 0, p.first_facet + k, 1});
  }
  ring.first.push_back(static_cast<std::uint32_t>(parts.size()));
  ring.parts.pixels = std::move(parts);
  for (const Pixel& p : ring.parts.pixels) {
    const Patch& patch = ring.parts.patches[ring.parts.facets[p.first_facet].first_patch];
    ring.depth_m.push_back(static_cast<float>((camera_from_world * patch.position_m).z));
  }
}

ViewCache cast(const Setting& s, const View& view, std::size_t k, int samples,
               const std::vector<std::array<int, 2>>& chosen) {
  const CacheOptions options{.samples = samples,
                             .paths = 0,
                             .patches = 1,
                             .penumbrae = false,
                             .inner_px = ring_edges_px[k],
                             .outer_px = ring_edges_px[k + 1],
                             .seed = 7 + k};
  return build_cache(s.caster, view, s.layout.lights, s.model.monomials(), chosen, options);
}

Ring ring_of(const Setting& s, std::size_t v, std::size_t k) {
  const View& view = s.recordings.views[v];
  std::vector<std::array<int, 2>> all, uneven;
  for (const Pixel& p : s.model.cache(v).pixels) all.push_back({p.x, p.y});
  Ring ring;
  ring.parts = cast(s, view, k, few, all);
  const std::vector<float> sums = facet_sums(ring.parts);
  std::vector<std::size_t> places;
  for (std::size_t p = 0; p < all.size(); ++p)
    if (!plain(ring.parts, sums, ring.parts.pixels[p], s.layout.lights.size())) {
      uneven.push_back(all[p]);
      places.push_back(p);
    }
  const ViewCache fine = cast(s, view, k, many, uneven);
  const auto facets = static_cast<std::uint32_t>(ring.parts.facets.size());
  append_facets(fine, ring.parts);
  for (std::size_t i = 0; i < places.size(); ++i) {
    ring.parts.pixels[places[i]] = fine.pixels[i];
    ring.parts.pixels[places[i]].first_facet += facets;
  }
  lend_indirect(s.model.cache(v), ring.parts);
  ring.sums = facet_sums(ring.parts);
  split(view.world_from_camera, ring);
  return ring;
}

// Between which edges r lies, and how far along in r^2.
struct Between {
  std::size_t below;
  double along;
};
Between between(double r) {
  std::size_t j = 0;
  while (j + 2 < ring_edges_px.size() && ring_edges_px[j + 1] <= r) ++j;
  const double a = ring_edges_px[j], b = ring_edges_px[j + 1];
  return {j, std::min(1.0, (r * r - a * a) / (b * b - a * a))};
}
// Of ring k in the disc that ends at edge j.
double share_of_disc(std::size_t k, std::size_t j) {
  if (k >= j) return 0;
  const double a = ring_edges_px[k], b = ring_edges_px[k + 1], r = ring_edges_px[j];
  return (b * b - a * a) / (r * r);
}

}  // namespace

std::vector<Rings> cast_rings(const Setting& s) {
  std::vector<Rings> rings(s.model.views());
  for (std::size_t v = 0; v < rings.size(); ++v) {
    rings[v].own.parts = s.model.cache(v);
    rings[v].own.sums = facet_sums(rings[v].own.parts);
    split(s.recordings.views[v].world_from_camera, rings[v].own);
    for (std::size_t k = 0; k < ring_count; ++k) rings[v].about[k] = ring_of(s, v, k);
  }
  return rings;
}

std::vector<double> radiance_of(const Ring& ring, const Frame& frame) {
  std::vector<std::uint32_t> parts;
  for (const std::uint32_t p : frame.picked)
    for (std::uint32_t i = ring.first[p]; i < ring.first[p + 1]; ++i) parts.push_back(i);
  std::vector<double> radiance(3 * parts.size());
  frame.model.predict_from(ring.parts, ring.sums, frame.state, frame.number, parts, radiance);
  return radiance;
}

double ring_weight(std::size_t k, double r) {
  const Between at = between(r);
  return (1 - at.along) * share_of_disc(k, at.below) + at.along * share_of_disc(k, at.below + 1);
}

double own_share(double r) {
  const Between at = between(r);
  return at.below == 0 ? 1 - at.along : 0;
}

}  // namespace gonio::relighting
