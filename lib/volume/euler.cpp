// Euler numbers. With 26-connectivity the solid is the union of closed cubes round its samples: a vertex, edge or face
// of the grid belongs to it where any of the 8, 4 or 2 samples round it is inside. With 6-connectivity it is the
// complex of samples, pairs, squares and cubes of samples that are all inside. Either way V - E + F - C.
#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <numeric>

#include "base/parallel.h"
#include "volume/sample_window.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

// Signed counts over the cells of a row: of groups of 1, 2, 4 and 8 samples that start at a cell's lowest corner. A
// group counts where all of it is inside (intersection) or any (union); groups of odd dimension count negatively.
template <class Join>
std::int64_t groups(const std::array<const std::uint64_t*, 4>& rows, std::size_t words, const Join& join) {
  std::int64_t sum = 0;
  for (std::size_t w = 0; w < words; ++w) {
    std::array<std::uint64_t, 8> at{};
    for (std::size_t n = 0; n < 4; ++n) {
      at[2 * n] = rows[n][w];
      at[2 * n + 1] = rows[n][w] >> 1 | (w + 1 < words ? rows[n][w + 1] << 63 : 0);
    }
    std::uint64_t any = 0;
    for (const std::uint64_t bits : at) any |= bits;
    if (any == 0) continue;
    for (unsigned group = 0; group < 8; ++group) {
      std::uint64_t joined = at[0];
      for (unsigned n = 1; n < 8; ++n)
        if ((n & ~group) == 0) joined = join(joined, at[n]);
      sum += std::popcount(group) % 2 == 0 ? std::popcount(joined) : -std::popcount(joined);
    }
  }
  return sum;
}

}  // namespace

std::int64_t euler_number(io::VolumeSource& source, double threshold, Connectivity inside) {
  const auto size = source.head().size;
  SampleWindow window(source, threshold, 2);
  std::vector<std::int64_t> of_row(size[1] + 1);
  std::int64_t sum = 0;
  for (std::size_t layer = 0; layer <= size[2]; ++layer) {
    window.advance_to(std::min(layer + 1, size[2]) - 1);
    parallel_for(
        0, size[1] + 1,
        [&](std::size_t row) {
          const std::array<const std::uint64_t*, 4> rows{window.bits(row, layer), window.bits(row + 1, layer),
                                                         window.bits(row, layer + 1), window.bits(row + 1, layer + 1)};
          of_row[row] = inside == Connectivity::six ? groups(rows, window.words(), std::bit_and<>())
                                                    : -groups(rows, window.words(), std::bit_or<>());
        },
        64);
    sum = std::accumulate(of_row.begin(), of_row.end(), sum);
  }
  return sum;
}

}  // namespace gonio::volume
