// surface.directional-subsurface: light within a translucent body remembers where it was going. The model
// directional-dipole takes the place of dipole; explain writes it.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_directional_subsurface() {
  static const Mechanism declaration{
      .id = "surface.directional-subsurface",
      .sentence = "Light that has entered a translucent body spreads on in the direction in which it was going.",
      .typical = "what falls in aslant shifts by a mean free path",
      .equation = "S = S_dipole + share (S_directional - S_dipole)",
      .source = "Frisvad, Hachisuka & Kjeldsen 2014",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"traced"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1.5,
                      .start = 0.5,
                      .typical = 1,
                      .meaning = "share of what the directional dipole adds"}},
      .conditions = {"surface.incidence-angle"},
      .mistaken_for = {{.with = "surface.subsurface", .told_apart = "a narrow beam that falls in aslant"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
