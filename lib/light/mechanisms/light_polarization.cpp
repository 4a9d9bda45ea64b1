// light.polarization: a lamp whose light is partly polarized. Equation: light/polarized_emitter.h; what surfaces make
// of it: surface/polarization.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& light_polarization() {
  static const Mechanism declaration{
      .id = "light.polarization",
      .sentence = "A lamp sends out partly polarized light, of which interfaces send back more where it lies across.",
      .typical = "1 to 10 % of the light, up to all of a highlight near the Brewster angle",
      .equation =
          "f *= 1 + m01 s1 + m02 s2, m the surface's Mueller matrix over its corner, (s1, s2) = degree_0 (cos 2a, "
          "-sin 2a) + degree_45 (sin 2a, cos 2a), a the angle from the lamp's axis to the s axis of wi and wo",
      .source = "Born & Wolf 1999, section 1.5; Atkinson & Hancock 2006, equation 3",
      .stage = "light",
      .target = Target::light,
      .domains = {"images"},
      .parameters = {{.name = "degree_0",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.99,
                      .upper = 0.99,
                      .start = 0.3,
                      .typical = 0.1,
                      .meaning =
                          "share polarized along the axis x carried along from +z to the lamp, less that across; "
                          "render takes it into account with --stokes"},
                     {.name = "degree_45",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.99,
                      .upper = 0.99,
                      .start = 0.3,
                      .typical = 0.1,
                      .meaning = "the same for axes turned by 45 degrees"}},
      .conditions = {"light.plane-azimuth", "surface.incidence-angle", "light.identity"},
      .mistaken_for = {{.with = "surface.anisotropy", .told_apart = "roll the camera, or turn the lamp about its axis"},
                       {.with = "surface.interface", .told_apart = "turn the lamp about its axis"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
