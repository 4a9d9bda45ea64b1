// board.print: every corner of a board stands somewhere of its own.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& board_print() {
  constexpr double most_m = 0.01, typical_m = 1e-4;
  static const Mechanism declaration{
      .id = "board.print",
      .sentence =
          "The corners of the calibration board stand each beside its printed place: the print is uneven, or its "
          "squares were set one by one.",
      .typical = "0.02 to 0.3 mm",
      .equation =
          "(x, y, z) += (x_m, y_m, z_m), three numbers of every corner; fitted less what shifts or stretches the whole "
          "board along x, along y, or shifts or tilts it out of its plane: that is its pose and board.scale",
      .source =
          "Lavest, Viala & Dhome, Do we really need an accurate calibration pattern to achieve a reliable camera "
          "calibration?, ECCV 1998",
      .stage = "board",
      .target = Target::board,
      .domains = {"boards"},
      .parameters =
          {{.name = "x_m",
            .unit = "m",
            .lower = -most_m,
            .upper = most_m,
            .typical = typical_m,
            .meaning = "of the corner, along the columns' direction, beside its printed place"},
           {.name = "y_m",
            .unit = "m",
            .lower = -most_m,
            .upper = most_m,
            .typical = typical_m,
            .meaning = "the same down the rows"},
           {.name = "z_m",
            .unit = "m",
            .lower = -most_m,
            .upper = most_m,
            .typical = typical_m,
            .meaning = "the same away from the viewer"},
           {.name = "column", .unit = "1", .lower = -1e4, .upper = 1e4, .meaning = "whole squares to the corner"},
           {.name = "row", .unit = "1", .lower = -1e4, .upper = 1e4, .meaning = "the same down the rows"},
           {.name = "of", .unit = "1", .lower = 0, .upper = 1e4, .meaning = "which of the boards, from 0"}},
      .conditions = {"board.x", "board.y", "board.radius"},
      .mistaken_for = {{.with = "board.shape", .told_apart = "measure the squares of one row with a caliper"},
                       {.with = "camera.rolling-shutter",
                        .told_apart = "a second camera that looks at the same board: motions would be the same"}},
      .lists = true,
  };
  return declaration;
}

}  // namespace gonio::mechanism
