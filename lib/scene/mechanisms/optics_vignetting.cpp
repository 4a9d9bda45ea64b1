// optics.vignetting: the lens passes less light towards the picture's edge.
#include "scene/mechanisms/optics_vignetting.h"

namespace gonio::mechanism {

const Mechanism& optics_vignetting() {
  static const Mechanism declaration{
      .id = "optics.vignetting",
      .sentence = "The lens passes less light towards the edge of the picture.",
      .typical = "10 to 50 % at the corners",
      .equation = "pixel value *= 1 - falloff r^2, r the distance from the picture's centre over half its width",
      .source = "Kang & Weiss 2000, equation 6 (geometric part, first order in r^2); Goldman 2010, equation 2",
      .stage = "optics",
      .target = Target::scene,
      .domains = {"tables", "images", "stacks"},
      .parameters = {{.name = "falloff",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.1,
                      .upper = 0.6,
                      .start = 0.05,
                      .typical = 0.2,
                      .meaning = "share of the light that is lost half a picture's width from its centre"}},
      .conditions = {"camera.image-radius"},
      .mistaken_for = {{.with = "light.lobe", .told_apart = "move the patch together with the light"},
                       {.with = "light.direction", .told_apart = "roll the camera: vignetting turns with it"}},
      .inputs = {{.name = "image_radius", .unit = "1", .lower = 0, .upper = 2.5}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return v * equation::optics_vignetting(p[0], at[0] * at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
