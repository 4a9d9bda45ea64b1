// structured-light.defocus: a projector's spots. Equation: scan/told_place.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& structured_light_defocus() {
  static const Mechanism declaration{
      .id = "structured-light.defocus",
      .sentence =
          "The projector is out of focus: its pixels are spots that run into each other, and bent cosines become "
          "truer.",
      .typical = "0.1 px^2 in focus, 1 to 10 px^2 out of it",
      .equation =
          "harmonic h of the shown cosines times exp(-spot_px2 (2 pi h periods / size)^2 / 2): of a true cosine "
          "contrast goes and the place stays; what is left of a bent one's ripple is what tells",
      .source = "Su, Zhou, von Bally & Vukicevic 1992 (defocused projection); Lei & Zhang 2009",
      .stage = "light",
      .target = Target::camera,
      .domains = {"clouds"},
      .parameters = {{.name = "spot_px2",
                      .unit = "px^2",
                      .lower = 0,
                      .upper = 100,
                      .start = 0.2,
                      .typical = 0.3,
                      .meaning = "variance of a spot along x and y beyond the pixel's own square"}},
      .conditions = {"projector.phase"},
      .mistaken_for = {{.with = "projector.gamma", .told_apart = "show grey steps, and measure their light"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
