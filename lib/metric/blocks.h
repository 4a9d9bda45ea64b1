// Square blocks of pixels as independent witnesses: neighbours in a picture err together, so standard errors are
// computed over blocks. 16 x 16 pixels, halved until at least 40 blocks cover the picture (or a block is one pixel).
#pragma once
#include <algorithm>
#include <cstddef>

namespace gonio::metric {

struct Blocks {
  int side = 16, columns = 1, rows = 1;
  Blocks(int width, int height) {
    const auto cover = [&](int length) { return (length + side - 1) / side; };
    while (side > 1 && cover(width) * cover(height) < 40) side /= 2;
    columns = cover(width);
    rows = cover(height);
  }
  std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t of(int x, int y) const {
    return static_cast<std::size_t>(y / side) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x / side);
  }
  std::size_t of_pixel(std::size_t p, int width) const {
    const auto w = static_cast<std::size_t>(width);
    return of(static_cast<int>(p % w), static_cast<int>(p / w));
  }
};

}  // namespace gonio::metric
