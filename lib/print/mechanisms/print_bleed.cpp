// print.bleed: pixels light up their neighbours.
#include "print/mechanisms/print_bleed.h"

namespace gonio::mechanism {

const Mechanism& print_bleed() {
  static const Mechanism declaration{
      .id = "print.bleed",
      .sentence = "Light of a pixel reaches its neighbours, through the projector's lens and scattered by the resin.",
      .typical = "0.5 to 3 pixels, with a tail that holds 5 to 30 % of the light",
      .equation =
          "L = K * I: K(r) = (1 - tail_share) exp(-r^2 / (2 sigma_m^2)) / (2 pi sigma_m^2) + tail_share (1 + "
          "r^2 / tail_m^2)^(-3/2) / (2 pi tail_m^2), over the pixels' squares; stated and found spreads follow "
          "one another",
      .source =
          "Luongo et al. 2020, section 4; Moffat, Astronomy & Astrophysics 3 "
          "(1969) 455",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "sigma_m",
                      .unit = "m",
                      .lower = 0,
                      .upper = 1e-3,
                      .start = 2e-5,
                      .typical = 2e-5,
                      .meaning = "standard deviation of the core"},
                     {.name = "tail_share",
                      .unit = "1",
                      .lower = 0,
                      .upper = 0.6,
                      .start = 0.1,
                      .typical = 0.1,
                      .meaning = "share of the light that lies in the tail"},
                     {.name = "tail_m",
                      .unit = "m",
                      .neutral = 1e-4,
                      .lower = 1e-6,
                      .upper = 5e-3,
                      .start = 1e-4,
                      .typical = 5e-5,
                      .meaning = "width of the tail"}},
      .conditions = {"print.neighbours", "print.edge"},
      .mistaken_for = {{.with = "print.growth", .told_apart = "checkers of several scales beside wide fields"},
                       {.with = "print.pixel-tilt", .told_apart = "the same checkers at both ends of the field"},
                       {.with = "the instrument's lateral resolution", .told_apart = "measure with a finer lens"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
