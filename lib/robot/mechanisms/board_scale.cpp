// board.scale: a board that was printed larger or smaller than stated. A camera alone sees only that one direction is
// stretched against the other; a robot's metres show the rest.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& board_scale() {
  static const Mechanism declaration{
      .id = "board.scale",
      .sentence = "The calibration board's squares are not as large as stated, or not square.",
      .typical = "0.1 to 1 %",
      .equation =
          "x -> (1 + scale_x) x, y -> (1 + scale_y) y in the board's frame; on tables of corners alone scale_x stands "
          "for the ratio (1 + scale_x) / (1 + scale_y) - 1",
      .source = "own; print and paper stretch differently along and across",
      .stage = "board",
      .target = Target::board,
      .domains = {"boards", "robot"},
      .parameters = {{.name = "scale_x",
                      .unit = "1",
                      .lower = -0.2,
                      .upper = 0.2,
                      .typical = 0.005,
                      .meaning = "stretch along the columns' direction"},
                     {.name = "scale_y",
                      .unit = "1",
                      .lower = -0.2,
                      .upper = 0.2,
                      .typical = 0.005,
                      .meaning = "stretch along the rows' direction"}},
      .conditions = {"board.roll", "camera.distance"},
      .mistaken_for = {{.with = "robot.link-length", .told_apart = "measure the board with a caliper"},
                       {.with = "focal aspect",
                        .told_apart = "measure the board with a caliper, or turn it by 90 degrees"},
                       {.with = "lens.radial", .told_apart = "measure the board with a caliper"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
