// Path tracing of one view, start to end. Kajiya 1986, "The rendering equation"; Veach 1997, chapters 8-10.
//
// At every vertex each light that is on is sampled once; where a light has an extent the direction drawn from the
// surface may meet it too, and the two are joined by the power heuristic (Veach 1997, section 9.2.4, beta = 2). Paths
// end by Russian roulette on their throughput, or after `max_bounces` scattering events. Pixel filter: the pixel's
// square.
//
// The same seed gives the same bytes whatever the number of threads: every pass of every pixel has its own random
// numbers (passes.h). Pictures that grow, stop, resume and are joined from shares: stopping.h, share.h, session.h.
#pragma once
#include <cstdint>

#include "io/image.h"
#include "render/film.h"
#include "render/integrator.h"
#include "render/passes.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::render {

struct Options {
  int spp = 256;
  std::uint64_t seed = 1;
  bool geometry = true;   // write the geometry channels too
  bool adaptive = false;  // overrides transport's: pictures that are compared draw the same numbers in every pixel
  Transport transport{};
};

// What identifies the picture of scene.views[view]; `scene_hash` where it will be joined with others.
PictureIdentity picture_identity(const scene::Scene& scene, std::size_t view, const Integrator& integrator,
                                 std::uint64_t seed, int samples_per_pass, std::string scene_hash = {});

// The simulated image of scene.views[view]; channels as in film.h: develop().
io::Image render(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Options& options);

}  // namespace gonio::render
