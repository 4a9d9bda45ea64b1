// projector.gamma: cosines that a projector's tone curve bends. Equation: projector_gamma.h; what it does to phases:
// scan/told_place.h.
#include "scan/mechanisms/projector_gamma.h"

#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& projector_gamma() {
  static const Mechanism declaration{
      .id = "projector.gamma",
      .sentence =
          "The projector's light is not in proportion to what it is told to show: cosines come out bent, and "
          "their phases ripple.",
      .typical = "exponents 1.8 to 2.4 where nothing was set; 0.02 left after a correction",
      .equation =
          "light = shown^gamma, 0 <= shown <= 1; the phase that N equal shifts give is off by about "
          "(b(N+1) - b(N-1)) / b(1) sin(N theta), b the bent cosine's harmonics",
      .source =
          "Guo, He & Chen 2004 (gamma in fringe projection); Pan, Kemao, Huang & Asundi 2009 (harmonics and shifts)",
      .stage = "light",
      .target = Target::camera,
      .domains = {"clouds"},
      .parameters = {{.name = "gamma",
                      .unit = "1",
                      .neutral = 1,
                      .lower = 0.3,
                      .upper = 4,
                      .start = 1.1,
                      .typical = 0.3,
                      .meaning = "exponent; above 1 what is dark gets darker"}},
      .conditions = {"projector.phase"},
      .mistaken_for = {{.with = "structured-light.motion", .told_apart = "show the same patterns at more shifts"}},
      .act =
          [](double v, std::span<const double>, std::span<const double> p) {
            return equation::projector_gamma(std::clamp(v, 0.0, 1.0), p) + (v - std::clamp(v, 0.0, 1.0));
          },
  };
  return declaration;
}

}  // namespace gonio::mechanism
