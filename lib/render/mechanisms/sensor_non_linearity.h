// sensor.non-linearity on one value: its closed forms; the tone curve is render/tone_curve.h. With u = v / reference:
//   quadratic   u (1 + quadratic u)
//   power law   u^gamma, and with a linear toe the coding of screens (IEC 61966-2-1, sRGB): (1 + toe) u^gamma - toe
//               above the place where a line through zero touches it, and that line below. sRGB is gamma = 1 / 2.4 and
//               toe = 0.055. For gamma > 1 it is the inverse of the coding with 1 / gamma, the decoding
//   shoulder    u (1 + shoulder) / (1 + shoulder u). After a power law with gamma > 1 it is an s-curve (Naka & Rushton
//               1966; Reinhard & Devlin 2005, equation 1): a toe, a straight part, and the shoulder of film
#pragma once
#include <algorithm>
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
// What is negative is mirrored about zero, in all that follow.
double sensor_power_law(double v, double gamma, double reference, double toe = 0);
double sensor_shoulder(double v, double shoulder, double reference);
double sensor_shoulder_undone(double reading, double shoulder, double reference);
// All forms one after the other, from the mechanism's parameters.
render::Response sensor_non_linearity(std::span<const double> parameters);

}  // namespace gonio::equation
