// See cells.h.
#include "relighting/cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gonio::relighting {

std::size_t cells_each(std::size_t pictures, std::size_t enough) {
  constexpr std::size_t wanted = 12;
  return pictures == 0 || pictures >= enough ? 1 : (wanted + pictures - 1) / pictures;
}

std::vector<std::vector<std::size_t>> cells_of(std::span<const std::array<int, 2>> pixels, std::size_t cells,
                                               std::size_t least) {
  cells = std::min(cells, std::max<std::size_t>(1, pixels.size() / std::max<std::size_t>(1, least)));
  const auto columns = static_cast<std::size_t>(std::max(1.0, std::round(std::sqrt(static_cast<double>(cells)))));
  const std::size_t rows = std::max<std::size_t>(1, cells / columns);
  std::vector<std::size_t> order(pixels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return pixels[i]; });
  const auto slice = [](auto first, auto last, std::size_t k, std::size_t n) {
    const auto size = static_cast<std::size_t>(last - first);
    return std::pair{first + static_cast<std::ptrdiff_t>(size * k / n),
                     first + static_cast<std::ptrdiff_t>(size * (k + 1) / n)};
  };
  std::vector<std::vector<std::size_t>> result;
  for (std::size_t c = 0; c < columns; ++c) {
    const auto [left, right] = slice(order.begin(), order.end(), c, columns);
    std::ranges::sort(left, right, {}, [&](std::size_t i) { return std::array{pixels[i][1], pixels[i][0]}; });
    for (std::size_t r = 0; r < rows; ++r) {
      const auto [from, to] = slice(left, right, r, rows);
      if (from != to) result.emplace_back(from, to);
    }
  }
  return result;
}

}  // namespace gonio::relighting
