// structured-light.subsurface: points within the thing. Equation: structured_light_subsurface.h.
#include "scan/mechanisms/structured_light_subsurface.h"

#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& structured_light_subsurface() {
  static const Mechanism declaration{
      .id = "structured-light.subsurface",
      .sentence =
          "Light enters the thing before it comes back (marble, skin, wax): points lie too deep, the deeper the "
          "more sharply the devices look at it from either side, and tell of the brighter side.",
      .typical = "0.02 to 0.5 mm deep, spread by 0.2 to 3 mm",
      .equation =
          "what the camera sees at X was lit at X + depth_m (s(wi) - s(wo)), s(w) = t / sqrt(1.5^2 - |t|^2), "
          "t = w - (w . n) n; and phases turned by spread_m (grad log E . e + H_across / (2 |k|) - spread_m H_along / "
          "2), E "
          "the irradiance, k = |k| e and H the phase's first and second derivatives along the surface",
      .source =
          "Godin et al. 2001 (marble); Holroyd & Lawrence 2011 (errors of phase shifting on translucent things); "
          "Jensen et al. 2001 (dipole)",
      .stage = "surface",
      .target = Target::scene,
      .domains = {"clouds"},
      .parameters = {{.name = "depth_m",
                      .unit = "m",
                      .lower = -0.002,
                      .upper = 0.01,
                      .start = 1e-4,
                      .typical = 2e-4,
                      .meaning = "depth from which light comes back, mean; negative: points stand before the thing"},
                     {.name = "exit_depth_m",
                      .unit = "m",
                      .lower = -0.002,
                      .upper = 0.01,
                      .start = 1e-4,
                      .typical = 2e-4,
                      .meaning = "depth from which light leaves; that of a body is depth_m"},
                     {.name = "spread_m",
                      .unit = "m",
                      .lower = -0.01,
                      .upper = 0.02,
                      .start = 5e-4,
                      .typical = 1e-3,
                      .meaning = "spread of where light enters; mean depth of what diffuses and of its mirror image"}},
      .conditions = {"surface.incidence-angle", "scene.depth"},
      .mistaken_for = {{.with = "geometry.scale",
                        .told_apart = "spray the thing with chalk, or measure it with a caliper"},
                       {.with = "projector.moved", .told_apart = "measure something opaque beside it"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
