// Is a Mueller matrix one that a passive element can have? Cloude 1986, "Group theory and polarisation algebra", Optik
// 75(1): it is a sum of those of Jones matrices where its coherency matrix
//   H = 1/4 sum over i, j of M_ij sigma_i (x) conj(sigma_j)
// has no negative eigenvalue. Passive: no state gains, M_00 + |(M_01, M_02, M_03)| <= 1.
#pragma once
#include <array>
#include <cmath>
#include <complex>

#include "optics/mueller.h"

namespace gonio::tests {

// Cholesky of H + tolerance: fails for a negative eigenvalue below -tolerance.
inline bool is_sum_of_jones(const optics::Mueller& m, double tolerance = 1e-9) {
  using C = std::complex<double>;
  using Pauli = std::array<std::array<C, 2>, 2>;
  // In the order of Stokes' parameters: s1 is sigma_z, s2 sigma_x; s3 = 2 Im(Ex Ey*) is sigma_y with its sign.
  const std::array<Pauli, 4> sigma = {Pauli{{{1, 0}, {0, 1}}}, Pauli{{{1, 0}, {0, -1}}}, Pauli{{{0, 1}, {1, 0}}},
                                      Pauli{{{0, C(0, 1)}, {C(0, -1), 0}}}};
  std::array<std::array<C, 4>, 4> h{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < 4; ++b)
          h[a][b] += 0.25 * m.m[4 * i + j] * sigma[i][a / 2][b / 2] * std::conj(sigma[j][a % 2][b % 2]);
  for (std::size_t k = 0; k < 4; ++k) h[k][k] += tolerance;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!(h[k][k].real() > 0)) return false;
    for (std::size_t r = k + 1; r < 4; ++r) {
      const C factor = h[r][k] / h[k][k];
      for (std::size_t c = k; c < 4; ++c) h[r][c] -= factor * h[k][c];
    }
  }
  return true;
}

inline bool is_passive(const optics::Mueller& m, double tolerance = 1e-9) {
  return is_sum_of_jones(m, tolerance) &&
         m(0, 0) + std::sqrt(m(0, 1) * m(0, 1) + m(0, 2) * m(0, 2) + m(0, 3) * m(0, 3)) <= 1 + tolerance;
}

}  // namespace gonio::tests
