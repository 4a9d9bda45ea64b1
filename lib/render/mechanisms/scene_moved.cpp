// scene.moved: in single pictures of a stack stands something else than in the others.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& scene_moved() {
  static const Mechanism declaration{
      .id = "scene.moved",
      .sentence =
          "Something moved while the pictures were taken: in parts of single pictures stands what the others do "
          "not show.",
      .typical = "1 to 20 % of a picture, any brightness",
      .equation = "v *= 1 + relative, within a box of single pictures (on the average over the box)",
      .source = "Khan, Akyuz & Reinhard, ICIP 2006 (ghosts in pictures that several exposures were merged to)",
      .stage = "transport",
      .target = Target::scene,
      .domains = {"stacks"},
      .parameters = {{.name = "relative",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -1,
                      .upper = 1e6,
                      .start = 0.1,
                      .typical = 0.5,
                      .meaning = "by which that part is brighter than the other pictures show it, its median"},
                     {.name = "left_px", .unit = "px", .lower = 0, .upper = 1e6, .meaning = "first column of the box"},
                     {.name = "top_px", .unit = "px", .lower = 0, .upper = 1e6, .meaning = "first row of the box"},
                     {.name = "width_px", .unit = "px", .lower = 0, .upper = 1e6, .meaning = "columns of the box"},
                     {.name = "height_px", .unit = "px", .lower = 0, .upper = 1e6, .meaning = "rows of the box"}},
      .conditions = {"image.identity"},
      .mistaken_for = {{.with = "light.second-source",
                        .told_apart = "the same exposures again: what moved is elsewhere"},
                       {.with = "optics.ghost", .told_apart = "a ghost stays as long as camera and lamps do"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
