// robot.warm-up, robot.joule-heating, robot.friction-heating: one body that is heated and loses heat to the room.
//
//   dT/dt = rate (target - T),   target = rest + what the heating would hold it at above that
// (first-order thermal response: heat loss proportional to the distance, of one heat capacity). The three differ in
// what drives them alone.
#pragma once
#include <cmath>
#include <string>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& robot_warm_up();
const Mechanism& robot_joule_heating();
const Mechanism& robot_friction_heating();

// What the three declare alike.
inline const char* const first_order_source =
    "first-order thermal response; Incropera & DeWitt, Fundamentals of Heat and Mass Transfer, section 5.1";
inline Parameter heating_rate() {
  return {.name = "rate_per_s",
          .unit = "1/s",
          .neutral = 0,
          .lower = 0,
          .upper = 0.1,
          .start = 7e-4,
          .typical = 7e-4,
          .meaning = "the reciprocal of the time constant; 0: the joint stays at its level"};
}
inline Parameter heating_level(const char* name, double start, const std::string& meaning) {
  return {.name = name,
          .unit = "K",
          .neutral = 300,
          .lower = 200,
          .upper = 500,
          .start = start,
          .typical = 10,
          .meaning = meaning + "; without effect at rate 0"};
}
inline Parameter heating_rise(const char* name, const char* unit, double start, const std::string& meaning) {
  return {.name = name,
          .unit = unit,
          .neutral = 0,
          .lower = 0,
          .upper = 1000,
          .start = start,
          .typical = start,
          .meaning = meaning + "; without effect at rate 0"};
}
}  // namespace gonio::mechanism

namespace gonio::equation {

// The temperature `step_s` later, while the target stands still. The same to the last bit at rate 0.
inline double first_order_heating(double temperature, double target, double rate_per_s, double step_s) {
  return temperature - (target - temperature) * std::expm1(-rate_per_s * step_s);
}

}  // namespace gonio::equation
