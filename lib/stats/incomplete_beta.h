// The incomplete beta function by its logarithm, for tails that a double cannot hold. Private to lib/stats.
#pragma once

namespace gonio::stats {

// log I_x(a, b), with y = 1 - x given as such: neither end loses digits.
double log_beta_regularised(double x, double y, double a, double b);

}  // namespace gonio::stats
