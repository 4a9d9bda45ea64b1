// volume.fog: the air, or the water, between lamp, object and eye scatters light.
#include "scene/mechanisms/volume_fog.h"

namespace gonio::mechanism {

const Mechanism& volume_fog() {
  static const Mechanism declaration{
      .id = "volume.fog",
      .sentence = "The air between lamp, object and camera scatters light: what is far is dimmer, and the air glows.",
      .typical = "1 to 30 % per metre",
      .equation =
          "L exp(-sigma_t d - sigma_f r) + albedo sigma_t / (4 pi) integral_0^d I exp(-sigma_t s - sigma_f r(s)) / "
          "r(s)^2 ds + albedo / 2 (1 - exp(-sigma_t d)) mean(L), sigma_f = sigma_t (1 - albedo / 2): d from the "
          "eye, r from the lamp, the mean over the picture",
      .source = "Schuster 1905; Blinn 1982; Sun, Ramamoorthi, Narasimhan & Nayar 2005",
      .stage = "transport",
      .target = Target::scene,
      .domains = {"images"},
      .parameters = {{.name = "sigma_t_per_m",
                      .unit = "1/m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 5,
                      .start = 0.1,
                      .typical = 0.2,
                      .meaning = "extinction: scattered and absorbed"},
                     {.name = "albedo",
                      .unit = "1",
                      .neutral = 0.8,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.8,
                      .typical = 0.3,
                      .meaning = "share of the extinction that is scattered"}},
      .conditions = {"scene.depth"},
      .mistaken_for = {{.with = "optics.veiling-glare", .told_apart = "the same object nearer and farther"},
                       {.with = "sensor.black-offset", .told_apart = "light off: an offset stays"},
                       {.with = "light.inverse-square", .told_apart = "the same object nearer and farther"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
