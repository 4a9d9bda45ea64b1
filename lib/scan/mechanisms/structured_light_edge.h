// Where the light came from that a camera's pixel sees through a blur: structured-light.edge.
//
// Of a scene of brightness J that a Gaussian of variance s per axis blurs to I = g * J, and that a pattern
// exp(i k . y) lights, the camera reads at x, completing the square in g(x - y) exp(i k . y),
//   exp(i k . x) exp(-s |k|^2 / 2) I(x + i s k):
// the phase is turned by arg I(x + i s k), exactly, and by the blurred picture alone, continued to complex places. Of
// long periods that is the place x + s grad I / I (Robbins 1956, "An empirical Bayes approach to statistics", from
// Tweedie). I is continued by the polynomial of fourth degree in either direction through a pixel and its neighbours.
#pragma once
#include <array>
#include <complex>

#include "geom/vector.h"

namespace gonio::equation {

using Neighbours = std::array<float, 25>;  // brightness, rows from above, the pixel itself in the middle

namespace edge {
// Lagrange's polynomials of the nodes -2, ..., 2.
inline std::array<std::complex<double>, 5> lagrange(std::complex<double> x) {
  std::array<std::complex<double>, 5> all;
  for (int i = 0; i < 5; ++i) {
    all[static_cast<std::size_t>(i)] = 1;
    for (int j = 0; j < 5; ++j)
      if (j != i) all[static_cast<std::size_t>(i)] *= (x - double(j - 2)) / double(i - j);
  }
  return all;
}
}  // namespace edge

// Radians; `k`: by how much the phase changes per pixel of the camera along x and y.
inline double structured_light_edge(const Neighbours& brightness, Vec2 k, double spread_px2) {
  const auto x = edge::lagrange({0, spread_px2 * k.x}), y = edge::lagrange({0, spread_px2 * k.y});
  std::complex<double> sum = 0;
  for (std::size_t j = 0; j < 5; ++j) {
    std::complex<double> row = 0;
    for (std::size_t i = 0; i < 5; ++i) row += double{brightness[5 * j + i]} * x[i];
    sum += row * y[j];
  }
  return std::arg(sum);
}

}  // namespace gonio::equation
