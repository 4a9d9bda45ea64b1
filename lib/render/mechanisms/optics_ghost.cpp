// optics.ghost: light goes to and fro between the lens' surfaces.
#include "render/mechanisms/optics_ghost.h"

namespace gonio::mechanism {

const Mechanism& optics_ghost() {
  static const Mechanism declaration{
      .id = "optics.ghost",
      .sentence =
          "Reflections between the lens' surfaces lay a faint picture, turned about the centre, over the picture.",
      .typical = "0.01 to 1 % of the source",
      .equation = "v(x) += share v(2 c - x), c the picture's centre",
      .source = "Hullin et al. 2011, Physically-based real-time lens flare rendering (one sharp in-plane ghost)",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"images"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.05,
                      .start = 0.005,
                      .typical = 0.003,
                      .meaning = "brightness of the ghost over that of its source"}},
      .conditions = {"image.mirrored-radiance", "image.radiance"},
      .mistaken_for = {{.with = "surface.interface",
                        .told_apart = "rotate the camera: a ghost moves against the scene"},
                       {.with = "optics.veiling-glare", .told_apart = "cover the brightest spot"}},
      .inputs = {{.name = "mirrored", .unit = "W/(m^2 sr)", .lower = 0, .upper = 10}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return equation::optics_ghost(v, p[0], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
