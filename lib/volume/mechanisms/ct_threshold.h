// ct.threshold on where a wall stands along its outward normal, voxels.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_threshold();
}

namespace gonio::equation {

inline double ct_threshold(double s, double offset_voxels) {
  return s + offset_voxels;
}

}  // namespace gonio::equation
