// lens.lateral-colour: a lens that magnifies the colours differently. Equation: camera/corner_model.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& lens_lateral_colour() {
  static const Mechanism declaration{
      .id = "lens.lateral-colour",
      .sentence =
          "The lens magnifies red, green and blue differently: towards the edge of the image edges have coloured "
          "fringes.",
      .typical = "0.2 to 3 px at the corners",
      .equation =
          "(x', y') of red and blue times 1 + linear + cubic r'^2, r'^2 = x'^2 + y'^2; green is the reference. Found "
          "on "
          "corner tables with a column channel (0 red, 1 green, 2 blue)",
      .source = "Mallon & Whelan, Pattern Recognition Letters 28(1), 2007, the radial part",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"boards", "images"},
      .parameters = {{.name = "red_linear",
                      .unit = "1",
                      .lower = -0.02,
                      .upper = 0.02,
                      .typical = 0.002,
                      .meaning = "red magnified by 1 + this"},
                     {.name = "red_cubic",
                      .unit = "1",
                      .lower = -0.1,
                      .upper = 0.1,
                      .typical = 0.01,
                      .meaning = "and with the cube of r'"},
                     {.name = "blue_linear",
                      .unit = "1",
                      .lower = -0.02,
                      .upper = 0.02,
                      .typical = 0.002,
                      .meaning = "blue magnified by 1 + this"},
                     {.name = "blue_cubic",
                      .unit = "1",
                      .lower = -0.1,
                      .upper = 0.1,
                      .typical = 0.01,
                      .meaning = "and with the cube of r'"}},
      .conditions = {"camera.image-radius-by-channel", "camera.channel", "camera.edge-shift-radial"},
      .mistaken_for = {{.with = "demosaicing", .told_apart = "photograph under narrow bands, one colour at a time"},
                       {.with = "sensor.crosstalk", .told_apart = "light the board with one colour at a time"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
