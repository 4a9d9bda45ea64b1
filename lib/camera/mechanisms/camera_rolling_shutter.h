// When a row is read: camera.rolling-shutter.
#pragma once

namespace gonio::equation {

// In readouts, from the middle row: tau = (v - (h - 1) / 2) / h. What is seen at row v stands at t + tau m.
inline double camera_rolling_shutter(double row, double rows) {
  return (row - 0.5 * (rows - 1)) / rows;
}

}  // namespace gonio::equation
