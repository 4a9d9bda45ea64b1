// camera.aspect: pixels that are not as high as wide. On boards the base model frees fx and fy apart. Equation:
// scene/edits/camera_aspect.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& camera_aspect() {
  static const Mechanism declaration{
      .id = "camera.aspect",
      .sentence = "The pixels are not square as stated: the picture is stretched along its columns.",
      .typical = "0.1 to 1 %; an anamorphic or resized picture by 10 to 100 %",
      .equation = "fy times 1 + relative",
      .source = "Hartley & Zisserman 2004, section 6.1",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"images"},
      .parameters = {{.name = "relative",
                      .unit = "1",
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.01,
                      .typical = 0.003,
                      .meaning = "change of fy over itself"}},
      .conditions = {"camera.edge-shift-y"},
      .mistaken_for = {{.with = "board.scale", .told_apart = "turn the board by 90 degrees"},
                       {.with = "camera.pose", .told_apart = "photograph from several places"},
                       {.with = "camera.focal-length", .told_apart = "roll the camera by 90 degrees"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
