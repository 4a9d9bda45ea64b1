// Pictures of cells (contrast/measure/measure_maps.h).
#include "contrast/measure/measure_maps.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "report/colour_map.h"
#include "stats/intervals.h"

namespace gonio::contrast {
namespace {

using report::Colour;
constexpr int side_px = 16;
constexpr Colour not_counted{0.62f, 0.62f, 0.62f}, frame{0.9f, 0.1f, 0.6f};

io::Image paint(const Measured& measured, bool framed, const std::function<Colour(std::size_t)>& colour) {
  const CellPattern& pattern = measured.pattern;
  io::Image picture(pattern.columns * side_px, pattern.rows * side_px, {"R", "G", "B"});
  std::vector<bool> bad(pattern.cells());
  for (const CellDefect& defect : measured.defects.found) bad[defect.cell] = framed;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto cell = static_cast<std::size_t>(y / side_px * pattern.columns + x / side_px);
      const int dx = std::min(x % side_px, side_px - 1 - x % side_px),
                dy = std::min(y % side_px, side_px - 1 - y % side_px);
      const Colour c = bad[cell] && std::min(dx, dy) < 2 ? frame : colour(cell);
      for (int k = 0; k < 3; ++k) picture.at(x, y, k) = c[static_cast<std::size_t>(k)];
    }
  return picture;
}

}  // namespace

io::Image pattern_map(const Measured& measured) {
  return paint(measured, false, [&](std::size_t cell) {
    const float v = measured.pattern.bits[cell] ? 1.0f : 0.0f;
    return Colour{v, v, v};
  });
}

io::Image view_map(const Measured& measured, std::size_t view) {
  std::vector<double> values;
  for (const double v : measured.views[view].means.mean)
    if (std::isfinite(v)) values.push_back(v);
  const double white = std::max(stats::quantile(values, 0.99), 1e-300);
  return paint(measured, false, [&](std::size_t cell) {
    const double v = measured.views[view].means.mean[cell];
    if (!std::isfinite(v)) return not_counted;
    const auto grey = static_cast<float>(std::pow(std::clamp(v / white, 0.0, 1.0), 1 / 2.2));
    return Colour{grey, grey, grey};
  });
}

double turn_limit(const Measured& measured) {
  double most = 0;
  for (const metric::Estimate& e : measured.cell_turn)
    if (std::isfinite(e.value)) most = std::max(most, std::abs(e.value));
  return most > 0 ? most : 1;
}

io::Image turn_map(const Measured& measured) {
  const double limit = turn_limit(measured);
  return paint(measured, true, [&](std::size_t cell) {
    const double v = measured.cell_turn[cell].value;
    return std::isfinite(v) ? report::signed_colour(v / limit) : not_counted;
  });
}

io::Image distance_map(const Measured& measured) {
  const double limit = std::max(measured.defects.limit, 1e-12);
  return paint(measured, true, [&](std::size_t cell) {
    const double d = measured.defects.distance[cell];
    return std::isfinite(d) ? report::magnitude_colour(d / (2 * limit)) : not_counted;
  });
}

}  // namespace gonio::contrast
