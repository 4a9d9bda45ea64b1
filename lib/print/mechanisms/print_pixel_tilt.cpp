// print.pixel-tilt: the projector stands at an angle to the membrane.
#include "print/mechanisms/print_pixel_tilt.h"

namespace gonio::mechanism {

const Mechanism& print_pixel_tilt() {
  static const Mechanism declaration{
      .id = "print.pixel-tilt",
      .sentence = "The projector is out of focus towards one side of its field: the blur grows with the place.",
      .typical = "0.5 to 2 pixels at the far side",
      .equation =
          "standard deviation of the spread: |slope_x| times the distance from the side x = 0 (slope_x > 0) or "
          "from the opposite one, and the same along y",
      .source =
          "Scheimpflug, GB patent 1196 (1904): the plane of focus of a tilted field; a blur that grows linearly with "
          "defocus",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "slope_x",
                      .unit = "1",
                      .lower = -0.2,
                      .upper = 0.2,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "spread for each metre along the rows of pixels"},
                     {.name = "slope_y",
                      .unit = "1",
                      .lower = -0.2,
                      .upper = 0.2,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "spread for each metre along the columns of pixels"}},
      .conditions = {"print.place-x", "print.place-y"},
      .mistaken_for = {{.with = "print.bleed", .told_apart = "the same checkers at both ends of the field"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
