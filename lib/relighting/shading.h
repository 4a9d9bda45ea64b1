// Direct light of sampled pixels: the part of a prediction that depends on surface terms and on the lights' size and
// place, but neither on albedos nor on intensities, in which an image is linear or nearly so.
//
// Per facet and light that is on: radiance = intensity (albedo * base + gloss), both per unit intensity and weighted by
// the facet's share of the pixel. Per facet: the share of irregular incident light that is sent on is albedo * base +
// gloss. For models without a diffuse base (metals) everything is gloss; where the base does not grow in proportion to
// the albedo (Model::proportional_to_albedo) it is split as if it did, about the present one.
//   base, gloss = sum over patches weight f(wo, wi) V cos(theta) / d^2,  f from lib/surface at albedo 0 and 1
// A light that is turned or moved takes its shadows along where the cache has them (relighting/lamp_shadows.h). Lamps
// with a lobe shine by it about the direction to the scene's centre (light.lobe); a directional light of finite
// nearness stands at 1 / nearness from the centre, where its irradiance is what the base model says, and falls with the
// square.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "relighting/light_cache.h"
#include "relighting/recordings.h"
#include "relighting/scattered.h"
#include "relighting/scene_state.h"

namespace gonio::relighting {

struct Shading {
  std::size_t lights = 0;           // on in this image
  std::vector<Scattered> direct;    // [facet of the picked pixels, in order][light of the image]
  std::vector<Scattered> indirect;  // [facet of the picked pixels, in order]
  // [facet of the picked pixels, in order][light of the image]: of the light that comes by way of other surfaces the
  // share that a lamp's lobe leaves; empty: all of it.
  std::vector<double> onward;
};

// Weights of the radius table's entries at one radius: cubic Hermite with tangents from the neighbouring nodes (Catmull
// & Rom 1974, for uneven spacing). At radius 0 the small light's entry is taken as it stands.
struct RadiusWeights {
  std::size_t first = 0, count = 1;
  std::array<double, 4> weight{1, 0, 0, 0};
  explicit RadiusWeights(double radius_m);
  double of(const float* table) const {
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) sum += weight[k] * table[first + k];
    return sum;
  }
};

// Weighted sums of a view's `direct` table over each facet's patches: [facet][light][radius].
std::vector<float> facet_sums(const ViewCache& cache);

class Shader {
 public:
  // All of them outlive it.
  Shader(const SceneLayout& layout, const Recording& image, const ViewCache& cache, std::span<const float> sums,
         ScatteredMemo& scattered)
      : layout_(layout), image_(image), cache_(cache), sums_(sums), scattered_(scattered) {}
  Shading operator()(const SceneState& state, std::span<const std::uint32_t> picked) const;
  // Without what facets send on of irregular light.
  Shading direct_alone(const SceneState& state, std::span<const std::uint32_t> picked) const;
  // The facets of one surface anew.
  void again(const SceneState& state, std::span<const std::uint32_t> picked, std::uint32_t surface,
             Shading& shading) const;
  // Shading::onward alone.
  std::vector<double> onward(const SceneState& state, std::span<const std::uint32_t> picked) const;
  // What the surface sends on of light that comes from everywhere, at a facet.
  Scattered scattered(const SurfaceState& surface, const Facet& facet) const;

 private:
  struct Lamp;
  std::vector<Lamp> lamps(const SceneState& state) const;
  double onward(const Lamp& lamp, std::size_t facet) const;
  Vec3 seen_from(const Facet& facet) const;  // in the frame of its normal
  double visible_now(const Lamp& lamp, std::size_t facet, double visible) const;
  std::size_t facets_of(std::span<const std::uint32_t> picked) const;
  Scattered direct(const SurfaceState& surface, const Extremes& extremes, std::size_t facet, const Lamp& lamp) const;
  void again(const SceneState& state, std::span<const std::uint32_t> picked, std::uint32_t surface,
             std::span<const Lamp> lamps, Shading& shading) const;
  void send_on_again(const SceneState& state, std::span<const std::uint32_t> picked, std::uint32_t surface,
                     Shading& shading) const;
  const SceneLayout& layout_;
  const Recording& image_;
  const ViewCache& cache_;
  std::span<const float> sums_;
  ScatteredMemo& scattered_;
};

}  // namespace gonio::relighting
