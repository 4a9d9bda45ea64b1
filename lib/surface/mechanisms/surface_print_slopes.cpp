// surface.print-slopes: steps of a print's layers show where its surface slopes against them. The law is print-normal
// (surface/laws/print_normal.cpp) with rho = alpha and s = 1 / share; explain writes it into the surface's "laws".
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_print_slopes() {
  static const Mechanism declaration{
      .id = "surface.print-slopes",
      .sentence = "A print is rougher where its surface slopes against the layers.",
      .typical = "share 0.2 to 0.5",
      .equation = "alpha' = alpha + (1 - alpha) share |sin(2 t)|^(1 / share), t from the print direction to the normal",
      .source = "Hannemose et al. 2020, equation 10",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"traced"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.2,
                      .typical = 0.3,
                      .meaning = "1 / s of the law print-normal"}},
      .conditions = {"object.slope"},
      .mistaken_for = {{.with = "surface.roughness", .told_apart = "walls beside slopes"},
                       {.with = "surface.polish", .told_apart = "slopes that are flat"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
