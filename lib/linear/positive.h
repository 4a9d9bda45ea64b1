// The inverse of a small symmetric positive definite matrix by L D L' without pivoting, for those that ask a million
// times: plain arrays, nothing allocated, inlined. solve.h has what to take otherwise.
#pragma once
#include <array>
#include <cstddef>

namespace gonio::linear {

// `a`: row by row, of which the lower triangle is read; `inverse` is whole. False, and `inverse` left as it is, where a
// pivot is not above `least` times its diagonal: the matrix is not positive definite as far as its rounding tells.
template <std::size_t N>
bool positive_inverse(const std::array<double, N * N>& a, std::array<double, N * N>& inverse, double least = 1e-14) {
  std::array<double, N * N> l{};  // unit lower triangle
  std::array<double, N> pivot{};
  for (std::size_t j = 0; j < N; ++j) {
    std::array<double, N> row{};  // l(j, k) d(k)
    double d = a[j * N + j];
    for (std::size_t k = 0; k < j; ++k) row[k] = l[j * N + k] * pivot[k], d -= row[k] * l[j * N + k];
    if (!(d > least * a[j * N + j])) return false;
    pivot[j] = d;
    for (std::size_t i = j + 1; i < N; ++i) {
      double sum = a[i * N + j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i * N + k] * row[k];
      l[i * N + j] = sum / d;
    }
  }
  // M = L^-1, unit lower triangle as well; the inverse is M' D^-1 M.
  std::array<double, N * N> m{};
  for (std::size_t j = 0; j < N; ++j) {
    m[j * N + j] = 1;
    for (std::size_t i = j + 1; i < N; ++i) {
      double sum = 0;
      for (std::size_t k = j; k < i; ++k) sum -= l[i * N + k] * m[k * N + j];
      m[i * N + j] = sum;
    }
  }
  std::array<double, N> per{};
  for (std::size_t k = 0; k < N; ++k) per[k] = 1 / pivot[k];
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t k = i; k < N; ++k) sum += m[k * N + i] * per[k] * m[k * N + j];
      inverse[i * N + j] = inverse[j * N + i] = sum;
    }
  return true;
}

}  // namespace gonio::linear
