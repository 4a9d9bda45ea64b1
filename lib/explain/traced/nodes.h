// A smooth curve through what was simulated at a few values of a number.
#pragma once
#include <span>
#include <vector>

namespace gonio::explain::traced {

// The cubic between the nodes beside x, with the slopes of parabolas through three nodes; straight on beyond. `nodes`
// grow; `y`: as many.
double between(const std::vector<double>& nodes, std::span<const double> y, double x);

}  // namespace gonio::explain::traced
