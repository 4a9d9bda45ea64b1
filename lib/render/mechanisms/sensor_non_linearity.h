// sensor.non-linearity on one value: its first two forms; the tone curve is render/tone_curve.h.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "mechanism/mechanism.h"
#include "render/tone_curve.h"

namespace gonio::mechanism {
const Mechanism& sensor_non_linearity();
}

namespace gonio::equation {

inline double sensor_quadratic(double v, double quadratic, double reference) {
  return v * std::max(0.0, 1 + quadratic * v / reference);  // bent down: no reading is negative far beyond full scale
}
// What is negative is mirrored about zero.
inline double sensor_power_law(double v, double gamma, double reference) {
  return reference * std::copysign(std::pow(std::abs(v / reference), gamma), v);
}
// All forms one after the other, from the mechanism's parameters.
render::Response sensor_non_linearity(std::span<const double> parameters);

}  // namespace gonio::equation
