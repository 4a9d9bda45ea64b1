// See coverage.h.
#include "alignment/coverage.h"

#include <algorithm>
#include <cmath>

namespace gonio::alignment {
namespace {

// One row's part of a side: it adds its height to all pixels to its right, and in its own pixels the area to its right.
// x0, x1 relative to pixel squares [k, k + 1); `height` signed.
void add_in_row(std::vector<double>& row, double x0, double x1, double height) {
  const double last = static_cast<double>(row.size()) - 2;
  x0 = std::clamp(x0, 0.0, last), x1 = std::clamp(x1, 0.0, last);
  if (x0 > x1) std::swap(x0, x1);
  const auto first = static_cast<std::size_t>(x0);
  // Differences: row[k] holds what changes from pixel k - 1 to k.
  if (x1 <= static_cast<double>(first) + 1) {
    const double right = static_cast<double>(first) + 1 - 0.5 * (x0 + x1);
    row[first] += height * right, row[first + 1] += height * (1 - right);
    return;
  }
  const double slope = height / (x1 - x0);
  double done = 0;  // area share that pixel k - 1 got
  for (std::size_t k = first; static_cast<double>(k) < x1; ++k) {
    const double from = std::max(x0, static_cast<double>(k)), to = std::min(x1, static_cast<double>(k) + 1);
    // Of the pixel: what crossed before it counts whole, what crosses in it from its place on.
    const double area = slope * (from - x0) + slope * (to - from) * (static_cast<double>(k) + 1 - 0.5 * (from + to));
    row[k] += area - done, done = area;
    if (static_cast<double>(k) + 1 >= x1) row[k + 1] += height - done;
  }
}

}  // namespace

std::vector<float> coverage_of(std::span<const Side> sides, int width, int height) {
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  std::vector<std::vector<double>> sums(rows, std::vector<double>(columns + 3, 0));
  for (const Side& side : sides) {
    const Vec2 a = side.from + Vec2{0.5, 0.5}, b = side.to + Vec2{0.5, 0.5};
    if (a.y == b.y) continue;
    const double sign = b.y > a.y ? -1 : 1;  // the region lies to the left: going down, at smaller x
    const Vec2 top = a.y < b.y ? a : b, bottom = a.y < b.y ? b : a;
    const double slope = (bottom.x - top.x) / (bottom.y - top.y);
    const auto first = static_cast<std::size_t>(std::clamp(std::floor(top.y), 0.0, static_cast<double>(rows)));
    for (std::size_t y = first; y < rows && static_cast<double>(y) < bottom.y; ++y) {
      const double y0 = std::max(top.y, static_cast<double>(y)), y1 = std::min(bottom.y, static_cast<double>(y) + 1);
      if (y1 > y0) add_in_row(sums[y], top.x + slope * (y0 - top.y), top.x + slope * (y1 - top.y), sign * (y1 - y0));
    }
  }
  std::vector<float> share(columns * rows);
  for (std::size_t y = 0; y < rows; ++y) {
    double sum = 0;
    for (std::size_t x = 0; x < columns; ++x) {
      sum += sums[y][x];
      share[y * columns + x] = static_cast<float>(std::clamp(sum, 0.0, 1.0));
    }
  }
  return share;
}

}  // namespace gonio::alignment
