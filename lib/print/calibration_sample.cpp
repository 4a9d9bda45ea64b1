// See calibration_sample.h.
#include "print/calibration_sample.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace gonio::print {
namespace {

constexpr int gap_px = 8, strip_px = 20, field_px = 10, quadrant_px = 64, least_repetitions = 4;
constexpr std::array<int, 4> squares_px{8, 4, 2, 1};
constexpr std::array<double, 3> slopes_rad{5 * pi / 180, 10 * pi / 180, 20 * pi / 180};
constexpr int wedge_layers = 10, wedge_high_px = 24;

int across(int count) {  // columns of a block that is about square
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count)))));
}

struct Extent {
  int wide = 0, high = 0;
};
Extent checkers_extent(int count) {
  const int columns = across(count), rows = (count + columns - 1) / columns, side = 2 * quadrant_px + gap_px;
  return {columns * side, rows * side};
}
Extent gradients_extent(int count, int greys) {
  return {greys * field_px + gap_px, count * (strip_px + gap_px)};
}
int wedge_px(const Printer& printer, double slope_rad) {
  return static_cast<int>(std::ceil(wedge_layers * printer.layer_m / std::tan(slope_rad) / printer.pixel_m.x));
}
Extent wedges_extent(const Printer& printer) {
  Extent e{gap_px, wedge_high_px + gap_px};
  for (const double slope : slopes_rad) e.wide += wedge_px(printer, slope) + gap_px;
  return e;
}

Extent whole(const Printer& printer, int count, int greys, bool wedges) {
  const Extent c = checkers_extent(count), g = gradients_extent(count, greys),
               w = wedges ? wedges_extent(printer) : Extent{};
  return {std::max(c.wide + g.wide, w.wide) + 2 * gap_px, std::max(c.high, g.high) + w.high + 2 * gap_px};
}

void place_checkers(CalibrationSample& sample, int count, int x0, int y0) {
  const int columns = across(count), side = 2 * quadrant_px + gap_px;
  for (int r = 0; r < count; ++r)
    for (int q = 0; q < 4; ++q) {
      const int x = x0 + r % columns * side + (q & 1) * quadrant_px,
                y = y0 + r / columns * side + (q >> 1) * quadrant_px;
      sample.checkers.push_back(
          {{x, y, x + quadrant_px, y + quadrant_px}, (r + 1.0) / count, r, squares_px[static_cast<std::size_t>(q)]});
    }
}

void place_gradients(CalibrationSample& sample, const SampleWish& wish, int count, int x0, int y0) {
  for (int r = 0; r < count; ++r)
    for (int k = 0; k < wish.greys; ++k) {
      const int x = x0 + (r % 2 == 0 ? k : wish.greys - 1 - k) * field_px, y = y0 + r * (strip_px + gap_px);
      const double share = k / (wish.greys - 1.0);
      sample.gradients.push_back(
          {{x, y, x + field_px, y + strip_px}, wish.darkest + share * (wish.brightest - wish.darkest), r, 0});
    }
}

}  // namespace

CalibrationSample calibration_sample(const Printer& printer, const SampleWish& wish) {
  CalibrationSample sample;
  int count = std::min(36, wish.repetitions);
  const auto fits = [&](int repetitions, bool wedges) {
    const Extent e = whole(printer, repetitions, wish.greys, wedges);
    return e.wide <= printer.width_px && e.high <= printer.height_px;
  };
  while (count > least_repetitions && !fits(count, true)) --count;
  const bool wedges = fits(count, true);
  if (!fits(count, wedges)) {
    const Extent e = whole(printer, count, wish.greys, false);
    throw Error(Exit::data, printer.place,
                format("has %d x %d pixels, %d repetitions need %d x %d", printer.width_px, printer.height_px, count,
                       e.wide, e.high),
                "print fewer grey values");
  }
  const Extent e = whole(printer, count, wish.greys, wedges);
  const int x0 = (printer.width_px - e.wide) / 2, y0 = (printer.height_px - e.high) / 2;
  sample.slab = {x0, y0, x0 + e.wide, y0 + e.high};
  sample.slab_layers = wish.slab_layers, sample.layers = wish.slab_layers + (wedges ? wedge_layers : 1);
  sample.repetitions = count;
  const Extent c = checkers_extent(count);
  place_checkers(sample, count, x0 + gap_px, y0 + gap_px);
  place_gradients(sample, wish, count, x0 + gap_px + c.wide + gap_px, y0 + gap_px);
  if (!wedges) return sample;
  int x = x0 + gap_px;
  for (const double slope : slopes_rad) {
    const int wide = wedge_px(printer, slope), y = y0 + e.high - gap_px - wedge_high_px;
    sample.wedges.push_back({{x, y, x + wide, y + wedge_high_px}, slope});
    x += wide + gap_px;
  }
  return sample;
}

std::vector<float> sample_layer(const CalibrationSample& sample, const Printer& printer, std::size_t layer) {
  const PixelBox& slab = sample.slab;
  const int wide = slab.x_end - slab.x_begin;
  std::vector<float> greys(static_cast<std::size_t>(wide) * static_cast<std::size_t>(slab.y_end - slab.y_begin),
                           layer < sample.slab_layers ? 1.0f : 0.0f);
  if (layer < sample.slab_layers) return greys;
  const auto paint = [&](const PixelBox& box, const auto& grey_at) {
    for (int y = box.y_begin; y < box.y_end; ++y)
      for (int x = box.x_begin; x < box.x_end; ++x)
        greys[static_cast<std::size_t>(y - slab.y_begin) * static_cast<std::size_t>(wide) +
              static_cast<std::size_t>(x - slab.x_begin)] =
            static_cast<float>(grey_at(x - box.x_begin, y - box.y_begin));
  };
  const std::size_t above = layer - sample.slab_layers;
  if (above == 0) {
    for (const SampleField& f : sample.gradients) paint(f.box, [&](int, int) { return f.grey; });
    for (const SampleField& f : sample.checkers)
      paint(f.box, [&](int x, int y) { return (x / f.square_px + y / f.square_px) % 2 == 0 ? f.grey : 0.0; });
  }
  for (const SampleWedge& w : sample.wedges)
    paint(w.box, [&](int x, int) {  // the mean height of the ramp within the pixel
      const double rise_m = (x + 0.5) * printer.pixel_m.x * std::tan(w.slope_rad), layer_m = printer.thickness_m(layer);
      const double share = std::clamp(rise_m / layer_m - static_cast<double>(above), 0.0, 1.0);
      return printer.growth.grey(share * layer_m, layer_m);
    });
  return greys;
}

}  // namespace gonio::print
