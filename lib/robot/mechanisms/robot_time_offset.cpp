// robot.time-offset: poses that were read earlier or later than the photograph. Equation: explain/robot/robot_chain.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& robot_time_offset() {
  static const Mechanism declaration{
      .id = "robot.time-offset",
      .sentence = "The stated poses lag behind the photographs of a moving robot by a fixed time.",
      .typical = "milliseconds",
      .equation =
          "base_from_tool(t) -> base_from_tool(t + lag_s), along the parabola through the poses before, at and after "
          "each image; images more than a second from their neighbours stay where they are",
      .source = "Furgale, Rehder & Siegwart, IROS 2013 (temporal calibration), with a local parabola for the spline",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"robot"},
      .parameters = {{.name = "lag_s",
                      .unit = "s",
                      .lower = -0.5,
                      .upper = 0.5,
                      .typical = 0.005,
                      .meaning = "the pose that belongs to an image is the one stated this much later"}},
      .conditions = {"robot.speed"},
      .mistaken_for = {{.with = "robot.backlash", .told_apart = "stop before each photograph"},
                       {.with = "camera.rolling-shutter", .told_apart = "stop before each photograph"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
