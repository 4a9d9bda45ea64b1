// sensor.blooming: what a full pixel cannot hold flows into its neighbours.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_blooming();
}

namespace gonio::equation {

// What flows over where `v` arrives. full_scale 0: pixels hold everything.
inline double overflow(double v, double full_scale) {
  return full_scale > 0 ? std::max(0.0, v - full_scale) : 0;
}

struct FourBeside {  // what arrives at the neighbours: two in the column, two in the row
  double up = 0, down = 0, left = 0, right = 0;
};
inline double sensor_blooming(double v, double along, double across, double full_scale, const FourBeside& beside) {
  const auto over = [full_scale](double arriving) { return overflow(arriving, full_scale); };
  return v + along * (over(beside.up) + over(beside.down)) + across * (over(beside.left) + over(beside.right));
}

}  // namespace gonio::equation
