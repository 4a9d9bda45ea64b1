// light.lobe: lamps fade to the sides, or have a shade that cuts a cone out of their light. Lamps of models led and
// spot have its numbers.
#include "light/mechanisms/light_lobe.h"

namespace gonio::mechanism {
namespace {

Parameter tilt_of_lobe(const char* name, const char* meaning) {
  return {.name = name,
          .unit = "rad",
          .neutral = 0,
          .lower = -0.8,
          .upper = 0.8,
          .start = 0,
          .typical = 0.1,
          .meaning = meaning};
}

double lobe_on(double v, std::span<const double> at, std::span<const double> p) {
  return v * equation::light_lobe(at[0], p);
}

}  // namespace

const Mechanism& light_lobe() {
  static const Mechanism declaration{
      .id = "light.lobe",
      .sentence = "The lamp does not shine equally in all directions but fades with the angle from its axis.",
      .typical = "10 to 50 %; a spot's cone has 10 to 45 degrees from its axis to its edge",
      .equation =
          "intensity *= cos(theta)^exponent S(t), theta the angle from the lamp's axis, S(t) = 3 t^2 - 2 t^3, t = "
          "(cos(theta) - cos(outer_rad)) / (cos(inner_share outer_rad) - cos(outer_rad)) within 0 .. 1; a lamp without "
          "an axis faces the scene's centre, from which R(tilt_x x + tilt_y y) turns it",
      .source =
          "Moreno, Avendano-Alejo & Tzonchev 2006, equation 1; cones: Pharr, Jakob & Humphreys 2023, section 12.2.1",
      .stage = "light",
      .target = Target::light,
      .domains = {"tables", "images"},
      .parameters = {{.name = "exponent",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 50,
                      .start = 1,
                      .typical = 2,
                      .meaning = "by which the lobe is narrower than the base model has it; an opening angle of half "
                                 "the intensity has -ln 2 / ln cos"},
                     {.name = "outer_rad",
                      .unit = "rad",
                      .neutral = std::numbers::pi,
                      .lower = 0.02,
                      .upper = std::numbers::pi / 2,
                      .start = 0.6,
                      .meaning = "angle from the axis beyond which it is dark; pi: no cone"},
                     {.name = "inner_share",
                      .unit = "1",
                      .neutral = 0.8,
                      .lower = 0,
                      .upper = 0.98,
                      .start = 0.5,
                      .typical = 0.3,
                      .meaning = "share of outer_rad within which nothing is lost; without effect where there is no "
                                 "cone"},
                     tilt_of_lobe("tilt_x_rad",
                                  "of the axis about the x carried along from +z to the way from the "
                                  "centre to the lamp; without effect where the lamp does not fade"),
                     tilt_of_lobe("tilt_y_rad",
                                  "of the axis about the y carried along; without effect where the lamp "
                                  "does not fade")},
      .conditions = {"light.emission-angle", "light.incidence-angle"},
      .mistaken_for = {{.with = "optics.vignetting",
                        .told_apart = "move the patch together with the light; or rotate the light alone"},
                       {.with = "light.inverse-square", .told_apart = "move the light along its axis"},
                       {.with = "light.position", .told_apart = "shadows: they follow a lamp that moves, not its cone"},
                       {.with = "reference.tile", .told_apart = "tilt the tile"}},
      .inputs = {{.name = "cosine", .unit = "1", .lower = -1, .upper = 1}},
      .act = lobe_on,
  };
  return declaration;
}

}  // namespace gonio::mechanism
