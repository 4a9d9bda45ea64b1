// surface.polish: polishing by hand reaches flat parts and not curved ones. The law is polish-curvature
// (surface/laws/polish_curvature.cpp) with rho = alpha and curvature_per_m = 1 / reach_m; explain writes it into the
// surface's "laws".
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_polish() {
  static const Mechanism declaration{
      .id = "surface.polish",
      .sentence = "What was polished by hand is smooth where it is flat, and rough where it curves.",
      .typical = "curvatures of 30 to 200 per metre, where it ends",
      .equation = "alpha' = alpha + (1 - alpha) / (1 + exp(s (1 - |H| reach_m))), H the mean curvature",
      .source = "Hannemose et al. 2020, equation 11",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"traced"},
      .parameters = {{.name = "reach_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.2,
                      .start = 0.01,
                      .typical = 0.015,
                      .meaning = "radius of curvature at which the surface is midway between polished and rough"},
                     {.name = "s",
                      .unit = "1",
                      .neutral = 4,
                      .lower = 0.5,
                      .upper = 20,
                      .start = 4,
                      .typical = 2,
                      .meaning = "how abruptly polish ends where the surface curves"}},
      .conditions = {"surface.curvature"},
      .mistaken_for = {{.with = "surface.print-slopes", .told_apart = "slopes that are flat"},
                       {.with = "surface.roughness", .told_apart = "flat parts beside edges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
