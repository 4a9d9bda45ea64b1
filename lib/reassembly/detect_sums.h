// Normal equations of rows with few columns, and the elimination of some of these. For detect*.cpp only.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

#include "linear/positive.h"

namespace gonio::reassembly {

// Upper triangle of the sums of products of rows of N numbers.
template <std::size_t N>
struct RowSums {
  std::array<double, N * N> sum{};
  void add(const std::array<double, N>& row, double weight = 1) {
    for (std::size_t i = 0; i < N; ++i) {
      const double a = weight * row[i];
      for (std::size_t j = i; j < N; ++j) sum[N * i + j] += a * row[j];
    }
  }
  double operator()(std::size_t i, std::size_t j) const { return sum[N * std::min(i, j) + std::max(i, j)]; }
};

template <std::size_t K, std::size_t N>
bool block_inverse(const RowSums<N>& rows, std::size_t from, const std::array<double, K>& ridge,
                   std::array<double, K * K>& inverse) {
  std::array<double, K * K> block{};
  for (std::size_t i = 0; i < K; ++i) {
    for (std::size_t j = 0; j < K; ++j) block[K * i + j] = rows(from + i, from + j);
    // Slightly more, to keep columns that nothing tells apart from growing.
    block[K * i + i] = block[K * i + i] * (1 + 1e-8) + ridge[i] + 1e-9;
  }
  return linear::positive_inverse<K>(block, inverse, 1e-12);
}

// Eliminates the columns [from, from + K) of symmetric sums: what remains of the others, as if they were orthogonal to
// those, `ridge` added to their squares. `solved` (K x N): coefficients of the eliminated columns for each of the
// others.
template <std::size_t K, std::size_t N>
void eliminate(RowSums<N>& rows, std::size_t from, const std::array<double, K>& ridge,
               std::array<double, K * N>& solved) {
  std::array<double, K * K> inverse{};
  solved.fill(0);
  if (!block_inverse(rows, from, ridge, inverse)) return;
  for (std::size_t i = 0; i < K; ++i)
    for (std::size_t c = 0; c < N; ++c)
      for (std::size_t j = 0; j < K; ++j) solved[N * i + c] += inverse[K * i + j] * rows(from + j, c);
  const RowSums<N> before = rows;
  for (std::size_t r = 0; r < N; ++r)
    for (std::size_t c = r; c < N; ++c)
      for (std::size_t j = 0; j < K; ++j) rows.sum[N * r + c] -= before(r, from + j) * solved[N * j + c];
}

}  // namespace gonio::reassembly
