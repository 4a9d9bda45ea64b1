#include "print/calibration_sample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "print/cure.h"
#include "print/prediction.h"

namespace gonio::print {
namespace {

constexpr double um = 1e-6;

Printer thesis_printer() {
  Printer p;
  p.name = p.place = "p";
  p.width_px = 2560, p.height_px = 1600, p.pixel_m = {15.08 * um, 15.08 * um}, p.layer_m = 18 * um;
  return p;
}

TEST(CalibrationSample, HoldsWhatItSays) {
  const Printer p = thesis_printer();
  const CalibrationSample s = calibration_sample(p);
  EXPECT_EQ(s.repetitions, 36);
  EXPECT_EQ(s.checkers.size(), 36u * 4);
  EXPECT_EQ(s.gradients.size(), 36u * 32);
  EXPECT_EQ(s.wedges.size(), 3u);
  const std::vector<float> layer = sample_layer(s, p, s.slab_layers);
  const int wide = s.slab.x_end - s.slab.x_begin;
  const auto grey = [&](int x, int y) {
    return layer[static_cast<std::size_t>((y - s.slab.y_begin) * wide + x - s.slab.x_begin)];
  };
  for (const SampleField& f : s.gradients)
    EXPECT_FLOAT_EQ(grey(f.box.x_begin + 3, f.box.y_begin + 3), static_cast<float>(f.grey));
  for (const SampleField& f : s.checkers) {
    EXPECT_FLOAT_EQ(grey(f.box.x_begin, f.box.y_begin), static_cast<float>(f.grey));
    EXPECT_FLOAT_EQ(grey(f.box.x_begin + f.square_px, f.box.y_begin), 0);
  }
}

// Ramps rise by their slopes: with growth in proportion the heights of all layers add up to it.
TEST(CalibrationSample, WedgesRiseByTheirSlopes) {
  const Printer p = thesis_printer();
  const CalibrationSample s = calibration_sample(p, {.slab_layers = 1});
  std::vector<std::vector<float>> layers;
  for (std::size_t k = 0; k < s.layers; ++k) layers.push_back(sample_layer(s, p, k));
  const CuredSurface surface = cured(p, s.slab, layers, 0);
  for (const SampleWedge& w : s.wedges)
    for (int x = w.box.x_begin + 2; x < w.box.x_end - 2; ++x) {
      const double z = surface.top_m[static_cast<std::size_t>((w.box.y_begin + 5 - s.slab.y_begin) * surface.width + x -
                                                              s.slab.x_begin)];
      EXPECT_NEAR(z, 18 * um + (x - w.box.x_begin + 0.5) * 15.08 * um * std::tan(w.slope_rad), 0.1 * um);
    }
}

TEST(CalibrationSample, TooSmallAPictureIsRefused) {
  Printer p = thesis_printer();
  p.width_px = p.height_px = 200;
  EXPECT_THROW(calibration_sample(p), Error);
}

// A map of a part of the sample as a microscope gives it: tilted, moved, noisy, with gaps. Its place is found to half a
// pixel, and the growth that it was printed with comes out.
TEST(CalibrationSample, GradientsAreReadFromATiltedMap) {
  Printer nominal = thesis_printer(), printer = nominal;
  const GrowthLaw law{17.9 * um, 8.8 * um, -0.01};
  printer.growth = Growth(law), printer.bleed = {6 * um, 0, 0};
  const CalibrationSample s = calibration_sample(nominal);
  const std::vector<std::vector<float>> layers{std::vector<float>(sample_layer(s, nominal, 0)),
                                               sample_layer(s, nominal, s.slab_layers)};
  const CuredSurface surface = cured(printer, s.slab, layers, 0);
  const SampleField& first = s.gradients.front();
  const int x0 = first.box.x_begin - 6 - s.slab.x_begin, y0 = first.box.y_begin - 6 - s.slab.y_begin, wide = 332,
            high = 240;
  Random random(8, 2);
  io::HeightMap map{.width = wide, .height = high, .step_x_m = 15.08 * um, .step_y_m = 15.08 * um, .z_m = {}};
  for (int y = 0; y < high; ++y)
    for (int x = 0; x < wide; ++x) {
      const double z = surface.top_m[static_cast<std::size_t>((y0 + high - 1 - y) * surface.width + x0 + x)];
      map.z_m.push_back(random.uniform() < 0.02 ? std::nan("")
                                                : z + 2e-3 * x * um - 5e-3 * y * um + 0.3 * um * random.normal());
    }
  const PixelGrid grid = nominal.grid();
  const Vec2 truth{grid.corner_m.x + (x0 + s.slab.x_begin + 0.5) * grid.pixel_m.x,
                   grid.corner_m.y + (y0 + s.slab.y_begin + high - 0.5) * grid.pixel_m.y};
  const SampleReading reading =
      read_gradients(map, s, nominal, {{truth.x + 70 * um, truth.y - 100 * um}, 0}, 10, "map");
  EXPECT_NEAR(reading.place.at_m.x, truth.x, 0.6 * 15.08 * um);
  EXPECT_NEAR(reading.place.at_m.y, truth.y, 0.6 * 15.08 * um);
  EXPECT_GE(reading.gradient.repetitions_m.size(), 7u);
  const GrowthFit fit = fit_growth(reading.gradient, "map");
  for (int k = 8; k <= 31; ++k) EXPECT_NEAR(fit.law.height_m(k / 31.0), law.height_m(k / 31.0), 0.1 * um);
  EXPECT_THROW(read_gradients(map, s, nominal, {{truth.x + 3e-3, truth.y}, 0}, 3, "map"), Error);
}

}  // namespace
}  // namespace gonio::print
