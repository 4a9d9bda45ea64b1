// sensor.row-pattern on one value.
#pragma once
#include <cmath>
#include <span>

#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_row_pattern();
}

namespace gonio::equation {

struct RowPattern {  // the mechanism's parameters, in its order
  double amplitude = 0, period_px = 100, phase_rad = 0, sine = 0, cosine = 0;
};
inline RowPattern row_pattern(std::span<const double> p) {
  return {p[0], p[1], p[2], p[3], p[4]};
}
inline double sensor_row_pattern(double v, const RowPattern& p, double row) {
  const double turn = 2 * pi * row / p.period_px;
  double swing = p.amplitude * std::sin(turn + p.phase_rad);
  if (p.sine != 0 || p.cosine != 0) swing += p.sine * std::sin(turn) + p.cosine * std::cos(turn);
  return v * (1 + swing);
}

}  // namespace gonio::equation
