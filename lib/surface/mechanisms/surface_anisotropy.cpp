// surface.anisotropy: the gloss has a direction. Equation: surface/gloss_lobes.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_anisotropy() {
  static const Mechanism declaration{
      .id = "surface.anisotropy",
      .sentence = "The surface is rougher in one direction than across it: brushed, rolled, woven or printed in lines.",
      .typical = "10 to 100 % between the two directions",
      .equation =
          "alpha_u = alpha exp(r), alpha_v = alpha exp(-r), r = hypot(anisotropy_0, anisotropy_45), u at "
          "atan2(anisotropy_45, anisotropy_0) / 2 from the tangent",
      .source = "Heitz 2014, section 5.3; Thibos, Wheeler & Horner 1997",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables", "images", "heights"},
      .parameters = {{.name = "anisotropy_0",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.8,
                      .upper = 0.8,
                      .start = 0.1,
                      .typical = 0.3,
                      .meaning = "half the logarithm of the roughness along the tangent over that across it"},
                     {.name = "anisotropy_45",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.8,
                      .upper = 0.8,
                      .start = 0.1,
                      .typical = 0.3,
                      .meaning = "the same for the axes turned by 45 degrees"}},
      .conditions = {"surface.azimuth", "surface.half-angle"},
      .mistaken_for = {{.with = "light.polarization", .told_apart = "roll the camera"},
                       {.with = "surface.micro-ridges", .told_apart = "rotate the sample by 90 degrees"},
                       {.with = "geometry.pose", .told_apart = "rotate the sample"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
