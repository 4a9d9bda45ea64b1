// surface.micro-ridges: facets of one slope, a grating. Equations: surface/ridges.h, explain/heights/heights_problem.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_micro_ridges() {
  static const Mechanism declaration{
      .id = "surface.micro-ridges",
      .sentence = "Parallel micro-ridges send the gloss to discrete angles: a grating, tool marks, layers of a print.",
      .typical = "gloss that moves by 5 to 30 degrees; periods of 0.5 to 100 um",
      .equation =
          "f = (1 - ridge_share) f + ridge_share F cos(ridge_rad) G D(h) / (4 cos_i cos_o) about normals tilted by "
          "+-ridge_rad across the ridges; height maps: z = ridge_amplitude_m cos(2 pi u / ridge_period_m)",
      .source = "Luongo et al. 2017, equations 2 to 6",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables", "heights"},
      .parameters = {{.name = "ridge_share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.2,
                      .meaning = "share of the gloss that the ridges send"},
                     {.name = "ridge_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = 0.03,
                      .upper = 0.8,
                      .start = 0.25,
                      .meaning = "tilt of the facets"},
                     {.name = "ridge_azimuth_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = -0.4,
                      .upper = 2.75,
                      .start = 0,
                      .meaning = "direction across the ridges, from the tangent"},
                     {.name = "ridge_period_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 1e-6,
                      .meaning = "height maps: distance of the ridges"},
                     {.name = "ridge_amplitude_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1e-3,
                      .start = 1e-8,
                      .meaning = "height maps: half the height of the ridges' first harmonic"}},
      .conditions = {"surface.azimuth", "surface.half-angle", "surface.spatial-frequency", "surface.lay-azimuth"},
      .mistaken_for = {{.with = "surface.anisotropy", .told_apart = "rotate the sample by 90 degrees"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
