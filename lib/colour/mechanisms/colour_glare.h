// colour.glare on what a camera reads of one patch of a chart.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& colour_glare();
}

namespace gonio::equation {

// `mean`: of the light that makes the veil, in this channel: of the whole picture, or of the chart's patches.
inline double colour_glare(double v, double share, double mean) {
  return v + share * mean;
}

}  // namespace gonio::equation
