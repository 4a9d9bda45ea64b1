// One mean per cell (contrast/measure/segmentation.h).
#include "contrast/measure/segmentation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace gonio::contrast {
namespace {

constexpr double not_counted = std::numeric_limits<double>::quiet_NaN();

struct Box {
  int left = 0, top = 0, right = -1, bottom = -1;
  bool whole = true;  // the pattern lies in the picture, and before the camera
};

Box box_of(const GreyView& view, const CellPattern& pattern, const ViewMap& map) {
  Box box;
  double left = 1e300, top = 1e300, right = -1e300, bottom = -1e300;
  for (int row = 0; row <= pattern.rows; ++row)
    for (int column = 0; column <= pattern.columns; ++column) {
      const auto at = map.pixel({column * pattern.cell_m.x, row * pattern.cell_m.y});
      if (!at) {
        box.whole = false;
        continue;
      }
      left = std::min(left, at->x);
      right = std::max(right, at->x);
      top = std::min(top, at->y);
      bottom = std::max(bottom, at->y);
    }
  box.left = static_cast<int>(std::clamp(std::ceil(left), 0.0, double(view.width)));
  box.top = static_cast<int>(std::clamp(std::ceil(top), 0.0, double(view.height)));
  box.right = static_cast<int>(std::clamp(std::floor(right), -1.0, view.width - 1.0));
  box.bottom = static_cast<int>(std::clamp(std::floor(bottom), -1.0, view.height - 1.0));
  return box;
}

struct Tally {
  double sum = 0, squares = 0, variance = 0, from = 0;
  int pixels = 0, saturated = 0, masked = 0;
};

// The cell whose inner share holds the place on the plane, or none.
std::optional<std::size_t> cell_at(const CellPattern& pattern, Vec2 at, double inner) {
  const double x = at.x / pattern.cell_m.x, y = at.y / pattern.cell_m.y;
  const double column = std::floor(x), row = std::floor(y);
  if (column < 0 || row < 0 || column >= pattern.columns || row >= pattern.rows) return std::nullopt;
  if (std::abs(x - column - 0.5) > inner / 2 || std::abs(y - row - 0.5) > inner / 2) return std::nullopt;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(pattern.columns) + static_cast<std::size_t>(column);
}

void add(Tally& tally, const GreyView& view, std::size_t pixel) {
  if (view.saturated[pixel]) ++tally.saturated;
  if ((!view.counts.empty() && !view.counts[pixel]) || !std::isfinite(view.value[pixel])) {
    ++tally.masked;
    return;
  }
  if (tally.pixels == 0) tally.from = view.value[pixel];
  const double v = view.value[pixel] - tally.from;
  tally.sum += v;
  tally.squares += v * v;
  if (!view.variance.empty()) tally.variance += view.variance[pixel];
  ++tally.pixels;
}

void finish(CellMeans& means, std::size_t cell, const Tally& tally, bool outside) {
  means.pixels[cell] = tally.pixels;
  if (outside)
    ++means.outside;
  else if (tally.saturated > 0)
    ++means.saturated;
  else if (tally.masked > 0)
    ++means.masked;
  else if (tally.pixels < min_pixels)
    ++means.few;
  else {
    const double n = tally.pixels, mean = tally.sum / n;
    const double scatter = std::max(0.0, tally.squares / n - mean * mean) * n / (n - 1);
    means.mean[cell] = tally.from + mean;
    means.sigma[cell] = std::sqrt(std::max(scatter, tally.variance / n) / n);
  }
}

// A cell is outside where a corner of its inner share is.
bool is_outside(const GreyView& view, const CellPattern& pattern, const ViewMap& map, std::size_t cell, double inner) {
  const Vec2 middle = pattern.middle_m(cell);
  for (const double sx : {-1.0, 1.0})
    for (const double sy : {-1.0, 1.0}) {
      const auto at =
          map.pixel({middle.x + sx * inner / 2 * pattern.cell_m.x, middle.y + sy * inner / 2 * pattern.cell_m.y});
      if (!at || at->x < -0.5 || at->y < -0.5 || at->x > view.width - 0.5 || at->y > view.height - 0.5) return true;
    }
  return false;
}

}  // namespace

std::optional<double> shortest_side_px(const CellPattern& pattern, const ViewMap& map) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int row = 0; row < pattern.rows; ++row)
    for (int column = 0; column < pattern.columns; ++column) {
      const auto at = [&](int dx, int dy) {
        return map.pixel({(column + dx) * pattern.cell_m.x, (row + dy) * pattern.cell_m.y});
      };
      const auto a = at(0, 0), b = at(1, 0), c = at(0, 1);
      if (!a || !b || !c) return std::nullopt;
      shortest = std::min({shortest, norm(*b - *a), norm(*c - *a)});
    }
  return shortest;
}

CellMeans cell_means(const GreyView& view, const CellPattern& pattern, const ViewMap& map, double inner) {
  CellMeans means;
  means.mean.assign(pattern.cells(), not_counted);
  means.sigma.assign(pattern.cells(), not_counted);
  means.pixels.assign(pattern.cells(), 0);
  means.cell_px = shortest_side_px(pattern, map).value_or(0);
  const Box box = box_of(view, pattern, map);
  std::vector<Tally> tallies(pattern.cells());
  const auto wide = static_cast<std::size_t>(std::max(0, box.right - box.left + 1));
  std::vector<std::optional<std::size_t>> cells(wide * static_cast<std::size_t>(std::max(0, box.bottom - box.top + 1)));
  parallel_for(
      0, wide > 0 ? cells.size() / wide : 0,
      [&](std::size_t line) {
        for (std::size_t k = 0; k < wide; ++k) {
          const Vec2 pixel{double(box.left) + double(k), double(box.top) + double(line)};
          if (const auto at = map.plane(pixel)) cells[line * wide + k] = cell_at(pattern, *at, inner);
        }
      },
      16);
  for (std::size_t i = 0; i < cells.size(); ++i)  // in the pixels' order: sums do not depend on threads
    if (cells[i])
      add(tallies[*cells[i]], view,
          (static_cast<std::size_t>(box.top) + i / wide) * static_cast<std::size_t>(view.width) +
              static_cast<std::size_t>(box.left) + i % wide);
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell)
    finish(means, cell, tallies[cell], is_outside(view, pattern, map, cell, inner));
  return means;
}

}  // namespace gonio::contrast
