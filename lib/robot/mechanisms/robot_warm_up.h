// robot.warm-up, robot.joule-heating, robot.friction-heating: one body that is heated and loses heat to the room.
//
//   dT/dt = rate (target - T),   target = rest + what the heating would hold it at above that
// (first-order thermal response: heat loss proportional to the distance, of one heat capacity). The three differ in
// what drives them alone.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& robot_warm_up();
const Mechanism& robot_joule_heating();
const Mechanism& robot_friction_heating();
}  // namespace gonio::mechanism

namespace gonio::equation {

// The temperature `step_s` later, while the target stands still. The same to the last bit at rate 0.
inline double first_order_heating(double temperature, double target, double rate_per_s, double step_s) {
  return temperature - (target - temperature) * std::expm1(-rate_per_s * step_s);
}

}  // namespace gonio::equation
