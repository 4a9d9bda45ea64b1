// reference.tile: a white standard that is not Lambertian. A property of how readings were
// normalised: `render` has no such stage.
#include "scene/mechanisms/reference_tile.h"

#include <cmath>

namespace gonio::mechanism {

const Mechanism& reference_tile() {
  static const Mechanism declaration{
      .id = "reference.tile",
      .sentence = "The white tile to which readings refer reflects less towards grazing than a Lambertian one.",
      .typical = "5 to 20 % at grazing angles",
      .equation = "v *= 1 + incidence (1 - cos theta_i)^2 + exitance (1 - cos theta_o)^2",
      .source =
          "Early, Barnes et al. 2000 (round robin of diffuse standards); lowest even order that leaves the normal",
      .stage = "reference",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {{.name = "incidence",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.6,
                      .upper = 0.6,
                      .start = 0.1,
                      .typical = 0.15,
                      .meaning = "relative excess at grazing incidence"},
                     {.name = "exitance",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.6,
                      .upper = 0.6,
                      .start = 0.1,
                      .typical = 0.15,
                      .meaning = "relative excess at grazing exitance"}},
      .conditions = {"surface.incidence-angle", "surface.exitance-angle"},
      .mistaken_for = {{.with = "light.lobe", .told_apart = "tilt the tile"},
                       {.with = "surface.diffuse-roughness", .told_apart = "measure a second, polished specimen"}},
      .inputs = {{.name = "theta_i", .unit = "rad", .lower = 0, .upper = 1.57},
                 {.name = "theta_o", .unit = "rad", .lower = 0, .upper = 1.57}},
      .act =
          [](double v, std::span<const double> at, std::span<const double> p) {
            return v * equation::reference_tile(p[0], p[1], std::cos(at[0]), std::cos(at[1]));
          },
  };
  return declaration;
}

}  // namespace gonio::mechanism
