// Groups of neighbouring points of a grid over a picture.
#pragma once
#include <cstdint>
#include <vector>

namespace gonio::explain::stacks {

struct GridRegion {
  std::vector<std::size_t> points;               // y * width + x
  int left = 0, top = 0, right = 0, bottom = 0;  // inclusive
};
// Of the points that count, those that touch, corners included; groups of at least `least` points, the largest first.
std::vector<GridRegion> grid_regions(const std::vector<std::uint8_t>& counts, int width, int height, std::size_t least);

}  // namespace gonio::explain::stacks
