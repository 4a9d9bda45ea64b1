// What a simulated printer makes of corrected greys: gradients that are straight, ridges that are as steep as they were
// asked for, checkers that show where the simulation says that they do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "manifest/document.h"
#include "print/calibration_sample.h"
#include "print/cure.h"
#include "print/design.h"
#include "relief/microstructure_use.h"

namespace gonio::print {
namespace {

constexpr double um = 1e-6;

Printer printer_of(const GrowthLaw& law, const Bleed& bleed) {
  Printer p;
  p.name = p.place = "p";
  p.width_px = p.height_px = 400, p.pixel_m = {7.54 * um, 7.54 * um}, p.layer_m = 18 * um;
  p.growth = Growth(law), p.bleed = bleed;
  return p;
}

// Mean heights of fields of `p`'s print of `greys`, above the slab.
std::vector<double> printed(const Printer& p, const std::vector<double>& greys) {
  constexpr int field = 8;
  const int wide = field * static_cast<int>(greys.size());
  std::vector<float> light(static_cast<std::size_t>(wide * field));
  for (int y = 0; y < field; ++y)
    for (int x = 0; x < wide; ++x)
      light[static_cast<std::size_t>(y * wide + x)] =
          static_cast<float>(std::lround(255 * greys[static_cast<std::size_t>(x / field)]) / 255.0);
  const CuredSurface s = cured(p, {0, 0, wide, field}, {light}, 0);
  std::vector<double> heights;
  for (std::size_t k = 0; k < greys.size(); ++k) {
    const float z = s.top_m[static_cast<std::size_t>(field / 2 * wide + field * static_cast<int>(k) + field / 2)];
    heights.push_back(std::isfinite(z) ? static_cast<double>(z) : 0);
  }
  return heights;
}

// Growth fitted to twelve repetitions with 0.4 um of noise a field, the next gradient sent through its inverse: it
// departs from a straight line by less than 1 % of the layer (rms over the fields). Forty printers; the noise of the
// fit itself allows for one or two that do not.
TEST(PrintedGradient, IsStraightOnceItIsCorrected) {
  Random random(17, 3);
  int straight = 0;
  for (int printer = 0; printer < 40; ++printer) {
    const double beta = random.uniform(6, 14);
    const double gamma = random.uniform(-0.02, 0.02);
    const GrowthLaw law{(18.2 - beta * std::log(1 - gamma)) * um, beta * um, gamma};
    const Printer p = printer_of(law, {});
    PrintedGradient measured;
    for (int k = 0; k < 32; ++k) measured.greys.push_back(k / 31.0 * 0.97);
    const std::vector<double> heights = printed(p, measured.greys);
    for (int r = 0; r < 12; ++r) {
      measured.repetitions_m.push_back(heights);
      for (double& h : measured.repetitions_m.back()) h += 0.4 * um * random.normal();
    }
    const Growth found(fit_growth(measured, "gradient").law);
    std::vector<double> greys, wished;
    for (int k = 1; k <= 24; ++k)
      wished.push_back(k / 24.0 * 17.5 * um), greys.push_back(found.grey(wished.back(), 18 * um));
    const std::vector<double> corrected = printed(p, greys);
    double sum = 0;
    for (std::size_t k = 0; k < greys.size(); ++k) sum += std::pow(corrected[k] - wished[k], 2);
    straight += std::sqrt(sum / static_cast<double>(greys.size())) < 0.01 * 18 * um;
  }
  EXPECT_GE(straight, 38);
}

// Ridges of 3 to 9 degrees on a printer that spreads light by half a pixel: the long facets' slope, by a straight line
// over their middle, is within a degree.
TEST(PrintedRidges, AreAsSteepAsTheyWereAskedFor) {
  const GrowthLaw law{18.2 * um, 10.24 * um, -0.01};
  const Printer p = printer_of(law, {4 * um, 0.02, 20 * um});
  for (const double degrees : {3.0, 6.0, 9.0}) {
    const double pitch_m = 13.26 * 7.54 * um;
    manifest::MicrostructureUse use = relief::parse_microstructure(
        "ridges:ridge_rad=" + std::to_string(degrees) + "deg,pitch_m=" + std::to_string(pitch_m * 1e6) + "um", "s",
        [](const std::string&, const std::string&) { return false; });
    const io::HeightMap map = printed_patch(p, relief::structure_of({}, use, 18 * um, "s"), {}, 120, 2);
    double n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0;
    for (std::size_t y = 0; y < map.height; ++y) {
      // y upwards from the patch's middle; within a pitch, the long facet falls from 0 to cos^2 of it.
      const double v =
          (static_cast<double>(map.height - 1 - y) - (static_cast<double>(map.height) - 1) / 2) * map.step_y_m;
      const double phase = v / pitch_m - std::floor(v / pitch_m);
      if (phase < 0.2 || phase > 0.75) continue;
      const double x = phase * pitch_m, z = map.at(map.width / 2, y);
      n += 1, sx += x, sz += z, sxx += x * x, sxz += x * z;
    }
    const double slope = (sxz / n - sx * sz / (n * n)) / (sxx / n - sx * sx / (n * n));
    EXPECT_NEAR(std::atan(-slope) * 180 / pi, degrees, 1) << degrees;
  }
}

// Peak to trough of checkers of 8 to 1 pixels: with light that spreads by 0.4 pixels all resolve, with 1.2 pixels the
// finest does not, as the light's own contrast says.
TEST(PrintedCheckers, ResolveWhereTheLightDoes) {
  const GrowthLaw law{18.2 * um, 10.24 * um, -0.01};
  const auto depth_of = [&](double sigma_px, int square) {
    const Printer p = printer_of(law, {sigma_px * 7.54 * um, 0, 0});
    constexpr int side = 64;
    std::vector<float> light(side * side);
    for (int k = 0; k < side * side; ++k)
      light[static_cast<std::size_t>(k)] = (k % side / square + k / side / square) % 2 == 0 ? 0.6f : 0.0f;
    const CuredSurface s = cured(p, {0, 0, side, side}, {std::vector<float>(side * side, 1.0f), light}, 0);
    float low = 1, high = 0;
    for (int y = 24; y < 40; ++y)
      for (int x = 24; x < 40; ++x) {
        const float z = s.top_m[static_cast<std::size_t>(y * side + x)];
        low = std::min(low, z), high = std::max(high, z);
      }
    return static_cast<double>(high - low);
  };
  for (const int square : {8, 4, 2, 1}) EXPECT_GT(depth_of(0.4, square), 5 * um) << square;
  EXPECT_GT(depth_of(1.2, 8), 8 * um);
  EXPECT_LT(depth_of(1.2, 1), 0.1 * um);
  // Light of one pixel's squares keeps exp(-(pi sigma)^2) of its contrast at most: about 5e-7 of it here.
}

}  // namespace
}  // namespace gonio::print
