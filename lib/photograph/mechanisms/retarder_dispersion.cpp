// retarder.dispersion: a plate that delays by a path, and not by a phase.
#include "photograph/mechanisms/retarder_dispersion.h"

namespace gonio::mechanism {

const Mechanism& retarder_dispersion() {
  static const Mechanism declaration{
      .id = "retarder.dispersion",
      .sentence = "A retarder delays short waves by more of a wave than was believed.",
      .typical =
          "order 1 of a plate whose two indices differ by the same at all wavelengths; 1.05 to 1.2 of quartz and "
          "mica, 1.3 to 2 of polymers; 0 of an achromat",
      .equation = "retardance = stated retardance (design wavelength / wavelength)^order",
      .source =
          "Collett 2005, section 5.4 (retardance = 2 pi (n_e - n_o) thickness / wavelength); Ghosh 1999, "
          "Dispersion-equation coefficients for the refractive index and birefringence of calcite and quartz",
      .stage = "optics",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {{.name = "order",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -1,
                      .upper = 3,
                      .start = 1,
                      .typical = 1,
                      .meaning = "1: by the wavelength alone; beyond: by the dispersion of the difference of indices"}},
      .conditions = {"light.wavelength"},
      .mistaken_for = {{.with = "polarizer.leak", .told_apart = "a second setting of the retarder"},
                       {.with = "polarizer.angle", .told_apart = "one narrow band"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
