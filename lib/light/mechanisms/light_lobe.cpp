// light.lobe: lamps fade to the sides. Equation: light/models/led.cpp; scene/mechanisms.cpp, narrow().
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& light_lobe() {
  static const Mechanism declaration{
      .id = "light.lobe",
      .sentence = "The lamp does not shine equally in all directions but fades with the angle from its axis.",
      .typical = "10 to 50 %",
      .equation =
          "intensity *= cos(theta)^exponent, theta the angle from the lamp's axis; a lamp without one faces the "
          "scene's centre",
      .source = "Moreno, Avendano-Alejo & Tzonchev 2006, equation 1",
      .stage = "light",
      .target = Target::light,
      .domains = {"tables", "images"},
      .parameters = {{.name = "exponent",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 50,
                      .start = 1,
                      .meaning = "by which the lobe is narrower than the base model has it; an opening angle of half "
                                 "the intensity has -ln 2 / ln cos"}},
      .conditions = {"light.emission-angle", "light.incidence-angle"},
      .mistaken_for = {{.with = "optics.vignetting",
                        .told_apart = "move the patch together with the light; or rotate the light alone"},
                       {.with = "light.inverse-square", .told_apart = "move the light along its axis"},
                       {.with = "reference.tile", .told_apart = "tilt the tile"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
