// Structure that no smooth curve follows: a ripple, rings, a beat. Rows are put in the order of a condition; where what
// is left were noise, neighbours from different blocks would have nothing in common.
//
//   z = sum a_i a_i+1 / sqrt(sum a_i^2 a_i+1^2),  a = residual over sigma along the condition's direction
// is standard normal then, whatever the noise is (each product has a sign of its own; a lag-one form of von Neumann,
// Ann. Math. Stat. 12, 1941), and the mean product is the mean square of the structure.
#pragma once
#include <optional>

#include "inference/engine.h"
#include "inference/system.h"

namespace gonio::inference {

struct SerialCorrelation {
  std::size_t condition = 0;
  double p = 1;       // among all conditions
  double power = 0;   // mean square of the structure in noise units
  double effect = 0;  // what --smallest-effect is held against
};
// The condition along which neighbours agree most; nothing where there is no condition.
std::optional<SerialCorrelation> serial_correlation(const System& system, const std::vector<double>& values);

}  // namespace gonio::inference
