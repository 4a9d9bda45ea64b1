// Ridges from a printer that is not the model's own: a simulator of resin in a vat (sealed/cure_simulator.h), which has
// oxygen, radicals that spread and conversion, prints a gradient; growth is fitted to what an instrument would read of
// it, ridges are sent through its inverse, and the same vat prints them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/random.h"
#include "geom/vector.h"
#include "manifest/document.h"
#include "manifest/sections/print.h"
#include "print/growth.h"
#include "print/printer.h"
#include "relief/microstructure_use.h"
#include "sealed/cure_simulator.h"

namespace gonio::print {
namespace {

constexpr double um = 1e-6, pixel_m = 7.54 * um, layer_m = 18 * um;
constexpr int side_px = 96, field_px = 8, slab = 2, cells = sealed::cells_per_pixel;

sealed::Cure vat(double core_px) {
  sealed::Cure cure;
  cure.side_px = side_px, cure.layers = slab + 1;
  if (core_px > 0) cure.core_px = core_px, cure.tail_share = 0.02, cure.tail_px = 2.6;
  return cure;
}

// Heights in layers of a picture over a white slab.
std::vector<double> printed(const sealed::Cure& cure, const sealed::Greys& picture) {
  std::vector<sealed::Greys> pictures(slab, sealed::Greys(picture.size(), 1.0));
  pictures.push_back(picture);
  return sealed::cured(cure, pictures);
}

// Fields of eight pixels, 36 greys four times, in an order that is drawn; the mean over the middle of each is read over
// the plane that its layer began at, with 0.4 um of noise.
GrowthFit calibrated(const sealed::Cure& cure, std::uint64_t seed) {
  constexpr int across = side_px / field_px, greys = 36, repetitions = across * across / greys;
  Random random(seed, 7);
  std::vector<int> order;
  for (int k = 0; k < across * across; ++k) order.push_back(k);
  for (std::size_t k = order.size(); k > 1; --k)
    std::swap(order[k - 1], order[random.below(static_cast<std::uint32_t>(k))]);
  PrintedGradient gradient;
  for (int k = 0; k < greys; ++k) gradient.greys.push_back(std::round(255.0 * k / (greys - 1)) / 255);
  gradient.repetitions_m.assign(repetitions, std::vector<double>(greys));
  sealed::Greys picture(side_px * side_px);
  for (int y = 0; y < side_px; ++y)
    for (int x = 0; x < side_px; ++x)
      picture[y * side_px + x] = gradient.greys[order[y / field_px * across + x / field_px] % greys];
  const std::vector<double> heights = printed(cure, picture);
  for (int field = 0; field < across * across; ++field) {
    constexpr int side = side_px * cells, first = field_px / 2 - 1;
    double sum = 0;
    for (int j = 0; j < 2 * cells; ++j)
      for (int i = 0; i < 2 * cells; ++i)
        sum += heights[((field / across * field_px + first) * cells + j) * side +
                       (field % across * field_px + first) * cells + i];
    const double above = std::max(0.0, sum / (4 * cells * cells) - slab);
    gradient.repetitions_m[order[field] / greys][order[field] % greys] = above * layer_m + 0.4 * um * random.normal();
  }
  return fit_growth(gradient, "gradient");
}

// The slope of the long facets, by straight lines over their middles, a mean over pitches.
double slope_deg(const std::vector<double>& heights, double pitch_m) {
  constexpr int side = side_px * cells, border = 10 * cells;
  double n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0;
  for (int y = border; y < side - border; ++y) {
    const double v = (y + 0.5 - 0.5 * side) * pixel_m / cells, phase = v / pitch_m - std::floor(v / pitch_m);
    if (phase < 0.2 || phase > 0.75) continue;
    const double x = phase * pitch_m, z = layer_m * heights[y * side + side / 2];
    n += 1, sx += x, sz += z, sxx += x * x, sxz += x * z;
  }
  return std::atan(-(sxz / n - sx * sz / (n * n)) / (sxx / n - sx * sx / (n * n))) * 180 / pi;
}

// Half a pixel of spread light, as the printer of Luongo et al. 2020 has, and none.
class RidgesOfAVat : public testing::TestWithParam<double> {};
TEST_P(RidgesOfAVat, AreAsSteepAsTheyWereAskedFor) {
  const sealed::Cure cure = vat(GetParam());
  const GrowthFit fitted = calibrated(cure, 41);
  const Growth growth(fitted.law);
  for (const double degrees : {3.0, 6.0, 9.0}) {
    const double pitch_m = 13.26 * pixel_m;
    const manifest::MicrostructureUse use = relief::parse_microstructure(
        "ridges:ridge_rad=" + std::to_string(degrees) + "deg,pitch_m=" + std::to_string(pitch_m * 1e6) + "um", "s",
        [](const std::string&, const std::string&) { return false; });
    const relief::ShareAt structure = relief::structure_of({}, use, layer_m, "s");
    sealed::Greys picture;
    constexpr int samples = 4;
    for (int y = 0; y < side_px; ++y)
      for (int x = 0; x < side_px; ++x) {
        double share = 0;
        for (int k = 0; k < samples * samples; ++k) {
          const Vec2 at{(x - side_px / 2 + (k % samples + 0.5) / samples) * pixel_m,
                        (y - side_px / 2 + (k / samples + 0.5) / samples) * pixel_m};
          share += structure({at, {at.x, at.y, (slab + 1) * layer_m}}) / (samples * samples);
        }
        picture.push_back(std::round(255 * growth.grey_of_share(share, layer_m)) / 255);
      }
    const double slope = slope_deg(printed(cure, picture), pitch_m);
    std::printf("  light spread by %.2g px: asked for %.0f degrees, printed %.2f\n", GetParam(), degrees, slope);
    EXPECT_NEAR(slope, degrees, 1) << degrees;
  }
}
INSTANTIATE_TEST_SUITE_P(Spreads, RidgesOfAVat, testing::Values(0.0, 0.53));

}  // namespace
}  // namespace gonio::print
