// board.corner-bias: a detector that puts every corner aside. Equation: camera/corner_model.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& board_corner_bias() {
  static const Mechanism declaration{
      .id = "board.corner-bias",
      .sentence =
          "The detector finds every corner by the same way beside where it is, as one with another pixel centre.",
      .typical = "0.5 px (OpenCV 4.6, measured)",
      .equation =
          "(u, v) += R(turned_rad) (bias_x_px, bias_y_px); turned_rad is the angle by which the picture was turned "
          "before its corners were sought. Where no picture was turned this is a shift of the principal point, exactly",
      .source = "own; half a pixel between two conventions of the pixel's centre",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"boards"},
      .parameters = {{.name = "bias_x_px",
                      .unit = "px",
                      .lower = -5,
                      .upper = 5,
                      .typical = 0.5,
                      .meaning = "shift of every corner along the rows of the picture that was searched"},
                     {.name = "bias_y_px",
                      .unit = "px",
                      .lower = -5,
                      .upper = 5,
                      .typical = 0.5,
                      .meaning = "shift of every corner along its columns"}},
      .conditions = {"camera.turned", "camera.image-x", "camera.image-y"},
      .mistaken_for = {{.with = "principal point",
                        .told_apart =
                            "seek the corners again in the pictures turned by 180 degrees, column turned_rad"},
                       {.with = "lens.tangential", .told_apart = "roll the camera by 180 degrees"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
