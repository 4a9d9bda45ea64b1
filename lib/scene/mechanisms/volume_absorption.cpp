// volume.absorption: the material takes light on the way. `render` (render/media.h)
// applies it to surfaces that let light through and have sigma_a_per_m.
#include "scene/mechanisms/volume_absorption.h"

namespace gonio::mechanism {

const Mechanism& volume_absorption() {
  static const Mechanism declaration{
      .id = "volume.absorption",
      .sentence = "The material absorbs some light on its way through.",
      .typical = "1 to 10 % per cm",
      .equation = "T *= exp(-sigma_a_per_m path_m)",
      .source = "Bouguer 1729, Beer 1852",
      .stage = "transport",
      .target = Target::surface,
      .domains = {"tables", "traced"},
      .parameters = {{.name = "sigma_a_per_m",
                      .unit = "1/m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1000,
                      .start = 1,
                      .typical = 5,
                      .meaning = "absorption coefficient"}},
      .conditions = {"volume.path-length"},
      .mistaken_for = {{.with = "surface albedo", .told_apart = "two thicknesses of the same material"},
                       {.with = "light.ambient", .told_apart = "two thicknesses of the same material"}},
      .inputs = {{.name = "path_m", .unit = "m", .lower = 0, .upper = 0.1}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return v * equation::volume_absorption(p[0], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
