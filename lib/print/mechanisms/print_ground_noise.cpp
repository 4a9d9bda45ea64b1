// print.ground-noise: the printer's own roughness.
#include "print/mechanisms/print_ground_noise.h"

namespace gonio::mechanism {

const Mechanism& print_ground_noise() {
  static const Mechanism declaration{
      .id = "print.ground-noise",
      .sentence =
          "The printer adds heights of its own to everything that it makes, at random: alike over some pixels, others "
          "in every print.",
      .typical = "0.2 to 2 um over 20 to 200 um",
      .equation = "covariance of two heights of one print = rms_m^2 exp(-distance^2 / (2 length_m^2))",
      .source = "Luongo et al. 2020, section 5 (ground noise); relief(1) fits the form that dlp-slice(1) predicts with",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "rms_m",
                      .unit = "m",
                      .lower = 0,
                      .upper = 1e-3,
                      .start = 1e-6,
                      .typical = 1e-6,
                      .meaning = "root mean square height"},
                     {.name = "length_m",
                      .unit = "m",
                      .neutral = 5e-5,
                      .lower = 0,
                      .upper = 1e-2,
                      .start = 5e-5,
                      .meaning = "standard deviation of the Gaussian that the covariance falls with"}},
      .conditions = {"print.height", "print.layer"},
      .mistaken_for = {{.with = "noise of the instrument", .told_apart = "measure the same print twice"},
                       {.with = "print.bleed", .told_apart = "print it twice: what differs is random"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
