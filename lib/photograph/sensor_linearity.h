// How codes of a sensor depend on the light, from a series of exposures of a steady lamp (sensor_series.h):
//   log x + h(x) = a_tile + log t + e_level
// x: mean code of a tile above dark; exp(a): light there; t: exposure time; h: a natural cubic spline, 0 at a code in
// the middle; e: the lamp's own change from exposure to exposure, of the variance that frames of one exposure show
// among each other, or more where exposures fit worse. Least squares; uncertainties follow from the temporal noise of
// tiles and from e. Linear codes are x exp(h(x)). Tiles of uneven light, and colours, see different codes in one
// exposure and tell the curve without the lamp. Exposure times count as stated: a shutter that is late by a constant
// shows as curvature at the dark end.
#pragma once
#include <string>
#include <vector>

#include "photograph/characterize.h"
#include "photograph/linearity.h"

namespace gonio::photograph {

struct SensorLinearity {
  std::string left_out;            // why the series tells nothing; else empty
  double p = 1;                    // of a linear sensor's chance to look like this (F test of all of h)
  double worst = 0, worst_at = 0;  // largest |exp(h) - 1| and its code
  double worst_sigma = 0;
  double reference = 0;            // code that stays
  std::vector<LinearityRow> rows;  // from code 0 to the brightest tile's
  bool significant() const { return left_out.empty() && p < 1e-3; }
};

SensorLinearity sensor_linearity(const SeriesSums& sums, const SensorFigures& figures);

}  // namespace gonio::photograph
