// The fast simulator of images: radiance of the sampled pixels from cached geometry and the scene's numbers.
//
//   L = gain (1 - falloff r^2) [ sum over facets (direct + indirect) + sky share * ambient ]
//   direct   = sum over lights I (albedo * base + gloss)                              explain/images/shading.h
//   indirect = weight / pi [ albedo * base * E + gloss * M ],  E = strength * sum over lights I p_l(albedos) + ambient
//   * p_sky(albedos)
//
// E the irradiance by way of other surfaces, M pi times the radiance about the mirror direction
// (explain/images/light_cache.h). For Lambertian surfaces this is what the path tracer computes; light between glossy
// surfaces is that of diffuse ones with the same albedo at 45 degrees.
#pragma once
#include <span>
#include <vector>

#include "explain/images/light_cache.h"
#include "explain/images/recordings.h"
#include "explain/images/scene_state.h"
#include "explain/images/shading.h"

namespace gonio::explain::images {

class ImageModel {
 public:
  ImageModel(const Recordings& recordings, const SceneLayout& layout, const render::Monomials& monomials,
             std::vector<ViewCache> views);

  // `picked`: which pixels of the image's view cache, ascending. Radiance has three channels a pixel.
  Shading shade(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked) const;
  void shade_again(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
                   std::uint32_t surface, Shading& shading) const;
  void compose(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
               const Shading& shading, std::span<double> radiance) const;
  void predict(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
               std::span<double> radiance) const {
    compose(state, image, picked, shade(state, image, picked), radiance);
  }
  // Variance of the prediction at `state`: Monte Carlo of the indirect light, sub-sampling of edges.
  void variance(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
                std::span<double> variance) const;

  const ViewCache& cache(std::size_t view) const { return views_[view]; }
  const SceneLayout& layout() const { return layout_; }
  const render::Monomials& monomials() const { return monomials_; }

 private:
  Shader shader(std::size_t image) const;
  const Recordings& recordings_;
  SceneLayout layout_;
  render::Monomials monomials_;
  std::vector<ViewCache> views_;
  std::vector<std::vector<float>> sums_;  // [view]: facet_sums()
};

// Distance of a pixel from the picture's centre over half the picture's width.
double image_radius(const io::Image& picture, int x, int y);

}  // namespace gonio::explain::images
