// Surfaces whose albedo is a picture: a printed board, a label. The picture is taken as it is: nothing of it is fitted.
// The surface's albedo is the texture's mean, and every facet has a tint, the albedo there over that mean.
//
// Where the texture changes, a pixel's brightness follows from the pose by the pixel and says nothing of light or
// camera that the even places beside it do not: of these few are asked, which tell where things are seen. A place is
// even where all rays within `even_margin_px` of the pixel's middle meet one instance at albedos that differ by no more
// than `even_change`.
#pragma once
#include <array>
#include <vector>

#include "relighting/light_cache.h"
#include "relighting/recordings.h"
#include "relighting/scene_state.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::relighting {

inline constexpr double even_margin_px = 2.5, even_change = 0.01;

// Albedos of textured surfaces become the means of their pictures.
void settle_textures(const scene::Scene& scene, SceneLayout& layout);

// True where no textured surface is met.
bool is_even(const scene::Scene& scene, const render::RayCaster& caster, const View& view, int x, int y);

// What facets' tints are asked of. The pictures' means are taken once: pictures may be large, and pixels few.
class Tints {
 public:
  explicit Tints(const scene::Scene& scene);
  // Sets the tints of a cache's facets. `rays`: along each side of a pixel.
  void apply(const render::RayCaster& caster, const View& view, ViewCache& cache, int rays = 5) const;

 private:
  const scene::Scene& scene_;
  std::vector<Rgb> means_;  // by surface; empty: nothing has a texture
};

}  // namespace gonio::relighting
