// Discrete Fourier transforms of tiles, and the window that they are seen through.
#pragma once
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

#include "geom/vector.h"

namespace gonio::relief {

using Complex = std::complex<double>;

// Cooley & Tukey 1965, radix two, in place; `stride` between the n numbers.
inline void transform(Complex* data, std::size_t n, std::size_t stride) {
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(data[i * stride], data[j * stride]);
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    const double angle = -2 * pi / static_cast<double>(length);
    for (std::size_t start = 0; start < n; start += length)
      for (std::size_t k = 0; k < length / 2; ++k) {
        const Complex w = std::polar(1.0, angle * static_cast<double>(k));
        Complex &a = data[(start + k) * stride], &b = data[(start + k + length / 2) * stride];
        const Complex t = w * b;
        b = a - t;
        a += t;
      }
  }
}

inline void transform_square(std::vector<Complex>& data, std::size_t n) {  // n x n, row after row
  for (std::size_t y = 0; y < n; ++y) transform(data.data() + y * n, n, 1);
  for (std::size_t x = 0; x < n; ++x) transform(data.data() + x, n, n);
}

// Hann's window of n points, centred between them.
inline double hann(std::size_t i, std::size_t n) {
  return 0.5 - 0.5 * std::cos(2 * pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
}

}  // namespace gonio::relief
