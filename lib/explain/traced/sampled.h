// Which pixels of the pictures are asked, and what is known of what they show.
//
// Two thirds show the objects in question, a third what is around them; pixels that show the border of an object are
// left out. Groups: with fewer than eight pictures each is cut into cells of about as many pixels, so that of one
// picture alone a part can be left out and predicted from the rest. Blocks: tiles of 8 x 8 pixels.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "relighting/recordings.h"
#include "render/ray_caster.h"
#include "surface/law.h"

namespace gonio::explain::traced {

struct SampledPixel {
  std::size_t image = 0;  // place in Recordings::images
  int x = 0, y = 0;
  std::uint32_t block = 0;
  std::optional<std::size_t> surface;  // place among those in question, seen first
  surface::LocalGeometry here;         // of it
  double incidence_rad = 0;            // of the line of sight
  double path_m = 0;                   // straight on through the object
};
struct Sampled {
  std::vector<SampledPixel> pixels;  // group by group; those of one picture follow each other
  std::vector<std::size_t> first;    // group g has pixels first[g] ... first[g + 1] - 1
  std::vector<std::string> groups;   // "view-0", "view-0, part 3"
};

// `surfaces`: those in question, places in scene.appearance.surfaces. `pixels`: in all pictures together, about.
Sampled sampled(const relighting::Recordings& recordings, const scene::Scene& scene, const render::RayCaster& caster,
                std::span<const std::size_t> surfaces, std::size_t pixels);

}  // namespace gonio::explain::traced
