// The fast simulator of images: radiance of the sampled pixels from cached geometry and the scene's numbers.
//
//   L = gain (1 - falloff r^2) [ sum over facets (direct + indirect) + sky share * ambient ]
//   direct   = sum over lights I (albedo * base + gloss)                              relighting/shading.h
//   indirect = weight / pi [ albedo * base * E + gloss * M ]
//   E        = strength * sum over lights I p_l(albedos) + ambient * p_sky(albedos)
//
// E the irradiance by way of other surfaces, M pi times the radiance about the mirror direction
// (relighting/light_cache.h). For Lambertian surfaces this is what the path tracer computes; light between glossy
// surfaces is that of diffuse ones with the same albedo at 45 degrees. Terms (relighting/term.h) edit the state
// before, and change what comes out after.
#pragma once
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "relighting/light_cache.h"
#include "relighting/recordings.h"
#include "relighting/scene_state.h"
#include "relighting/shading.h"
#include "relighting/shading_memo.h"
#include "relighting/term.h"

namespace gonio::relighting {

class ImageModel {
 public:
  ImageModel(const Recordings& recordings, const SceneLayout& layout, const render::Monomials& monomials,
             std::vector<ViewCache> views);

  // Terms in play, numbered through; their starting amounts enter layout().start. Given ones first.
  void add_uses(std::vector<Use> uses, bool in_play);
  // The uses of another model of the same scene, prepared for this one's pixels.
  void take_uses(const ImageModel& other, std::vector<Use> uses);
  const std::vector<Use>& uses() const { return uses_; }

  // States are raw, amounts not yet applied, but for `edited`. `picked`: which pixels of the image's view cache,
  // ascending. Radiance has three channels a pixel.
  SceneState edited(const SceneState& state, std::size_t image) const;
  void predict(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
               std::span<double> radiance) const;

  // The steps of predict(), of an edited state: direct light, terms that change it, pixels, the camera.
  Shading shade(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked) const;
  void shade_again(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                   std::uint32_t surface, Shading& shading) const;
  void shade_terms(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                   Shading& shading) const;
  // The first two at once; what has been asked for of late is not computed again.
  std::shared_ptr<const Shaded> shaded(const SceneState& edited, std::size_t image,
                                       std::span<const std::uint32_t> picked) const;
  void compose(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
               const Shading& shading, std::span<double> radiance) const;
  // Radiance before and after terms that are not added anew (Term::anew), by the place of the use.
  struct Addition {
    std::vector<double> before, after;
  };
  using Additions = std::map<std::size_t, Addition>;
  void add_terms(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                 std::span<double> radiance, Additions* noted = nullptr) const;
  // The same near the state in which additions were noted: these go along with what they are added to instead of being
  // simulated anew.
  void add_terms_again(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                       const Additions& noted, std::span<double> radiance) const;
  void record_terms(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                    std::span<double> values) const;
  // The base model's prediction from another cache of the same pixels, as if nothing but geometry differed.
  void predict_from(const ViewCache& cache, std::span<const float> sums, const SceneState& edited, std::size_t image,
                    std::span<const std::uint32_t> picked, std::span<double> radiance) const;
  // Direct light that facets of another cache of the same view send to the camera, before exposure and weighted by
  // their share of the pixel: one value for each facet of the picked pixels, in order.
  std::vector<Rgb> direct_from(const ViewCache& cache, std::span<const float> sums, const SceneState& edited,
                               std::size_t image, std::span<const std::uint32_t> picked) const;
  // Variance of the prediction at `state`: Monte Carlo of the indirect light, sub-sampling of edges.
  void variance(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
                std::span<double> variance) const;

  const ViewCache& cache(std::size_t view) const { return views_[view]; }
  // Irradiance of a facet from a small light of unit intensity: V cos / d^2.
  double small_light(std::size_t view, std::size_t facet, std::size_t light) const {
    const double weight = views_[view].facets[facet].weight;
    return weight > 0 ? sums_[view][(facet * layout_.lights.size() + light) * radii_m.size()] / weight : 0;
  }
  const SceneLayout& layout() const { return layout_; }
  const render::Monomials& monomials() const { return monomials_; }
  const Recordings& recordings() const { return recordings_; }
  std::size_t views() const { return views_.size(); }
  ScatteredMemo& scattered() const { return *scattered_; }

 private:
  Shader shader(std::size_t image) const;
  void compose_from(const ViewCache& cache, const SceneState& edited, std::size_t image,
                    std::span<const std::uint32_t> picked, const Shading& shading, std::span<double> radiance) const;
  template <class Hook>
  void run_hooks(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                 const Hook& hook) const;
  const Recordings& recordings_;
  SceneLayout layout_;
  render::Monomials monomials_;
  std::vector<ViewCache> views_;
  std::vector<std::vector<float>> sums_;  // [view]: facet_sums()
  std::vector<Use> uses_;
  std::vector<std::size_t> ordered_;  // uses by their terms' order
  std::unique_ptr<ShadingMemo> memo_;
  std::unique_ptr<ScatteredMemo> scattered_;
};

// Light by way of other surfaces at one state: what a facet of the view's cache sends to the camera, before exposure
// and for the whole pixel.
class Onward {
 public:
  Onward(const ImageModel& model, const SceneState& edited, std::size_t image);
  ~Onward();
  Rgb operator()(std::size_t facet) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

// Factor of gain and vignetting on the radiance of a pixel.
Rgb exposure_of(const SceneState& edited, const Recording& image, std::size_t number, const Pixel& pixel);

// Distance of a pixel from the picture's centre over half the picture's width.
double image_radius(const io::Image& picture, int x, int y);

}  // namespace gonio::relighting
