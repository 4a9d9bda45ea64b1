// board.warp: a calibration board that is not flat. Equation: camera/board_terms.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& board_warp() {
  static const Mechanism declaration{
      .id = "board.warp",
      .sentence = "The calibration board is not flat: paper or panel bulges by fractions of a millimetre.",
      .typical = "0.05 to 1 mm",
      .equation =
          "z += sag_x_m (1 - x^2) + sag_y_m (1 - y^2), x, y in [-1, 1] over the board's inner corners, z away from the "
          "viewer",
      .source = "Kogan, mrcal 2021 (calobject warp)",
      .stage = "board",
      .target = Target::board,
      .domains = {"boards", "robot"},
      .parameters = {{.name = "sag_x_m",
                      .unit = "m",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 5e-4,
                      .meaning = "sag along the columns' direction"},
                     {.name = "sag_y_m",
                      .unit = "m",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 5e-4,
                      .meaning = "sag along the rows' direction"}},
      .conditions = {"board.radius", "board.x", "board.y", "camera.obliqueness"},
      .mistaken_for = {{.with = "lens.radial",
                        .told_apart = "turn the board by 90 degrees, photograph it at two ranges"},
                       {.with = "lens.non-central", .told_apart = "turn the board by 90 degrees"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
