// polarizer.angle: axes beside where they are stated.
#include "photograph/mechanisms/polarizer_angle.h"

namespace gonio::mechanism {
namespace {

Parameter turn(const char* name, double typical, const char* meaning) {
  return {.name = name,
          .unit = "rad",
          .neutral = 0,
          .lower = -0.4,
          .upper = 0.4,
          .start = 0.02,
          .typical = typical,
          .meaning = meaning};
}

}  // namespace

const Mechanism& polarizer_angle() {
  static const Mechanism declaration{
      .id = "polarizer.angle",
      .sentence = "The axes of the polarizers stand beside where they are stated to be.",
      .typical = "0.5 to 3 degrees where the camera is mounted, 0.2 to 1 degree among the four of a grid",
      .equation = "a = stated angle + turn_rad + that of its own polarizer",
      .source =
          "Collett 2005, equation 4-42; Gimenez et al. 2019, Calibration for polarization cameras (axes differ by "
          "up to a degree)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"polarization", "tables"},
      .parameters = {turn("turn_rad", 0.03, "of all axes, from the picture's x towards up"),
                     turn("turn_45_rad", 0.01, "beside that, of the axis at 45 degrees"),
                     turn("turn_90_rad", 0.01, "beside that, of the axis at 90 degrees"),
                     turn("turn_135_rad", 0.01, "beside that, of the axis at 135 degrees")},
      .conditions = {"light.polarized-across", "polarimeter.analyser"},
      .mistaken_for = {{.with = "screen.angle", .told_apart = "light that a surface has polarized"},
                       {.with = "geometry.pose", .told_apart = "edges in the picture tell how the camera is rolled"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
