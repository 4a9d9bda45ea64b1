// light.ambient: stray light of the room. In space: light/models/uniform.cpp.
#include "light/mechanisms/light_ambient.h"

namespace gonio::mechanism {

const Mechanism& light_ambient() {
  static const Mechanism declaration{
      .id = "light.ambient",
      .sentence = "Weak light arrives from all directions, besides the lamps.",
      .typical = "0.1 to 5 %",
      .equation = "incident radiance from every open direction += (radiance_r, radiance_g, radiance_b)",
      .source = "irradiance of an open plane: pi times the radiance",
      .stage = "light",
      .target = Target::scene,
      .domains = {"tables", "images", "stacks", "traced"},
      .parameters = {{.name = "radiance_r",
                      .unit = "W/(m^2 sr)",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.01,
                      .meaning = "radiance of the surroundings, linear red"},
                     {.name = "radiance_g",
                      .unit = "W/(m^2 sr)",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.01,
                      .meaning = "radiance of the surroundings, linear green"},
                     {.name = "radiance_b",
                      .unit = "W/(m^2 sr)",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.01,
                      .meaning = "radiance of the surroundings, linear blue"}},
      .conditions = {"scene.ambient-visibility", "light.visibility", "image.radiance"},
      .mistaken_for = {{.with = "sensor.black-offset", .told_apart = "lens cap, or the same scene at two exposures"},
                       {.with = "optics.veiling-glare", .told_apart = "mask the bright areas"},
                       {.with = "transport.indirect", .told_apart = "switch the lamp off: ambient light stays"}},
      .inputs = {{.name = "exposure_s", .unit = "s", .lower = 0, .upper = 10},
                 {.name = "channel", .unit = "1", .lower = 0, .upper = 2}},
      .act =
          [](double v, std::span<const double> at, std::span<const double> p) {
            return v + equation::light_ambient(p[static_cast<std::size_t>(at[1])]) * at[0];
          },
  };
  return declaration;
}

}  // namespace gonio::mechanism
