// Measures against pairs whose differences are known: null pairs, injected differences, masks, NaN. False-alarm rates
// are stated.
#include "metric/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/random.h"
#include "metric/difference_pictures.h"

namespace gonio::metric {
namespace {

double truth(int x, int y, int c) {
  return 0.2 + 0.15 * std::sin(0.05 * x + c) * std::cos(0.07 * y);
}

LinearPicture picture(int width, int height, bool variance) {
  LinearPicture p;
  p.name = "test";
  p.colour = io::Image(width, height, {"R", "G", "B"});
  if (variance) p.variance = p.colour;
  p.clipped.assign(p.colour.pixels(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) p.colour.at(x, y, c) = static_cast<float>(truth(x, y, c));
  return p;
}

// Photon and read noise on the photograph, noise of known variance on the rendering; photograph = scale * rendering.
Overlay null_pair(int side, double scale, std::uint64_t seed) {
  const manifest::Noise noise{5000, 0.002};
  LinearPicture photograph = picture(side, side, false), rendering = picture(side, side, true);
  Random random(seed);
  for (std::size_t i = 0; i < photograph.colour.data.size(); ++i) {
    const double v = photograph.colour.data[i];
    photograph.colour.data[i] =
        static_cast<float>(v + std::sqrt(v / noise.gain + noise.read * noise.read) * random.normal());
    const double variance = 4e-5 * v * v / (scale * scale);
    rendering.colour.data[i] = static_cast<float>(v / scale + std::sqrt(variance) * random.normal());
    rendering.variance.data[i] = static_cast<float>(variance);
  }
  return lay_over("pair", std::move(photograph), std::move(rendering), nullptr, Channels::all, noise);
}

TEST(Comparison, NullPairsHaveTheTailsOfTheNormalLaw) {
  const Measures m = measure(null_pair(1000, 1, 7), {});
  ASSERT_TRUE(m.z_rms && m.z_above_3);
  EXPECT_NEAR(m.z_rms->value, 1, 0.003);            // 3 million samples: 7 standard errors
  EXPECT_NEAR(m.z_above_3->value, 0.0027, 0.0005);  // 0.27 +- 0.05 %: 17 standard errors
  EXPECT_LT(std::abs(m.z_above_3->value - 0.0027), 5 * m.z_above_3->sigma);
}

TEST(Comparison, NoVarianceNoZ) {
  const Measures m =
      measure(lay_over("pair", picture(64, 64, false), picture(64, 64, true), nullptr, Channels::all, {}), {});
  EXPECT_FALSE(m.z_rms);
  EXPECT_TRUE(m.rmse);
}

TEST(Comparison, RecoversInjectedDifferences) {
  LinearPicture rendering = picture(96, 80, false);
  double square = 0;
  for (const float v : rendering.colour.data) square += double{v} * v;
  const double rms = std::sqrt(square / static_cast<double>(rendering.colour.data.size()));
  for (std::size_t i = 0; i < rendering.colour.data.size(); ++i)
    rendering.colour.data[i] += i % 2 == 0 ? 0.01f : -0.01f;
  const Measures m =
      measure(lay_over("pair", picture(96, 80, false), std::move(rendering), nullptr, Channels::all, {}), {});
  EXPECT_NEAR(m.rmse->value, 0.01, 1e-6);
  EXPECT_NEAR(m.relative_rmse->value, 0.01 / rms, 1e-5);
  EXPECT_NEAR(m.log10_error->value, -2, 1e-5);
  EXPECT_NEAR(m.mean_difference, 0, 1e-6);
  EXPECT_LT(m.ssim->value, 1);
}

TEST(Comparison, OfEqualPicturesIsPerfect) {
  const Measures m =
      measure(lay_over("pair", picture(64, 64, false), picture(64, 64, false), nullptr, Channels::all, {}), {});
  EXPECT_EQ(m.rmse->value, 0);
  EXPECT_NEAR(m.ssim->value, 1, 1e-6);
  EXPECT_NEAR(m.log10_error->value, std::log10(m.log_floor), 1e-9);
}

// The jackknife's sigma of RMSE against the spread of 60 repetitions, with errors that are alike over 4 x 4 pixels and
// three channels: single samples taken as witnesses would state a sigma seven times too small. The ratio's standard
// error is 10 %.
TEST(Comparison, StandardErrorsAreHonestWhereNeighboursErrTogether) {
  constexpr int repetitions = 60, side = 96;
  double sum = 0, squares = 0, stated = 0;
  for (int k = 0; k < repetitions; ++k) {
    Random random(100 + static_cast<std::uint64_t>(k));
    LinearPicture rendering = picture(side, side, false);
    for (int y = 0; y < side; y += 4)
      for (int x = 0; x < side; x += 4) {
        const auto error = static_cast<float>(0.01 * random.normal());
        for (int i = 0; i < 48; ++i) rendering.colour.at(x + i % 4, y + i / 4 % 4, i / 16) += error;
      }
    const Measures m =
        measure(lay_over("pair", picture(side, side, false), std::move(rendering), nullptr, Channels::all, {}), {});
    sum += m.rmse->value;
    squares += m.rmse->value * m.rmse->value;
    stated += m.rmse->sigma / repetitions;
  }
  const double spread = std::sqrt((squares - sum * sum / repetitions) / (repetitions - 1));
  EXPECT_NEAR(stated / spread, 1, 0.4);
}

// 95 % intervals of the exposure scale over 400 pairs: coverage has a standard error of 1.1 %, so that 90 to 98 % is
// missed by an honest interval about once in a thousand.
TEST(Exposure, IntervalsCoverTheTruth) {
  int covered = 0;
  for (std::uint64_t k = 0; k < 400; ++k) {
    const Overlay o = null_pair(80, 1.7, 1000 + k);
    const Overlay* all[] = {&o};
    const Estimate e = fit_exposure(all);
    covered += std::abs(e.value - 1.7) < 1.96 * e.sigma;
  }
  EXPECT_GE(covered, 360);
  EXPECT_LE(covered, 392);
}

TEST(Exposure, NoiseInTheRenderingDoesNotBendIt) {
  Random random(3);
  LinearPicture photograph = picture(200, 200, true), rendering = picture(200, 200, true);
  for (std::size_t i = 0; i < photograph.colour.data.size(); ++i) {
    const double v = photograph.colour.data[i];
    photograph.colour.data[i] = static_cast<float>(v + 0.05 * random.normal());
    rendering.colour.data[i] = static_cast<float>(v + 0.1 * random.normal());
    photograph.variance.data[i] = 0.0025f;
    rendering.variance.data[i] = 0.01f;
  }
  const Overlay o = lay_over("pair", std::move(photograph), std::move(rendering), nullptr, Channels::all, {});
  const Overlay* all[] = {&o};
  const Estimate e = fit_exposure(all);
  EXPECT_NEAR(e.value, 1, 4 * e.sigma);  // plain least squares would give about 0.83
  EXPECT_LT(e.sigma, 0.005);
}

TEST(Exposure, OfABlackRenderingIsRefused) {
  LinearPicture black = picture(32, 32, false);
  std::ranges::fill(black.colour.data, 0.0f);
  const Overlay o = lay_over("pair", picture(32, 32, false), std::move(black), nullptr, Channels::all, {});
  const Overlay* all[] = {&o};
  EXPECT_THROW(fit_exposure(all), Error);
}

TEST(Comparison, NotANumberAlwaysFails) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    for (const bool in_photograph : {true, false}) {
      LinearPicture photograph = picture(32, 32, false), rendering = picture(32, 32, false);
      (in_photograph ? photograph : rendering).colour.at(9, 4, 1) = bad;
      const Measures m = measure(lay_over("pair", photograph, rendering, nullptr, Channels::all, {}), {});
      EXPECT_EQ(m.not_finite.pixels, 1);
      EXPECT_EQ(m.not_finite.x, 9);
      EXPECT_EQ(m.not_finite.y, 4);
      EXPECT_EQ(m.not_finite.channel, "G");
      EXPECT_EQ(m.not_finite.in_photograph, in_photograph);
      EXPECT_FALSE(m.rmse);
      ASSERT_EQ(violations(m, {}).size(), 1u);
      EXPECT_THAT(violations(m, {})[0], testing::HasSubstr("(9, 4)"));

      Mask mask{32, 32, std::vector<std::uint8_t>(32 * 32, 1)};
      mask.counts[4 * 32 + 9] = 0;  // masked out, it is nobody's business
      EXPECT_TRUE(
          violations(measure(lay_over("pair", photograph, rendering, &mask, Channels::all, {}), {}), {}).empty());
    }
}

TEST(Comparison, CountsOnlyWhatTheMaskCounts) {
  LinearPicture rendering = picture(40, 40, false);
  Mask mask{40, 40, std::vector<std::uint8_t>(1600, 0)};
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      mask.counts[static_cast<std::size_t>(40 * y + x)] = x < 20;
      if (x >= 20) rendering.colour.at(x, y, 0) += 1;
    }
  const Measures m =
      measure(lay_over("pair", picture(40, 40, false), std::move(rendering), &mask, Channels::all, {}), {});
  EXPECT_EQ(m.pixels, 800);
  EXPECT_EQ(m.rmse->value, 0);
}

TEST(Comparison, RefusesWhatCannotBeLaidOver) {
  const Mask empty{40, 40, std::vector<std::uint8_t>(1600, 0)}, small{20, 40, std::vector<std::uint8_t>(800, 1)};
  const auto lay = [](int width, const Mask* mask) {
    return lay_over("pair", picture(40, 40, false), picture(width, 40, false), mask, Channels::all, {});
  };
  EXPECT_THROW(lay(39, nullptr), Error);
  EXPECT_THROW(lay(40, &empty), Error);
  EXPECT_THROW(lay(40, &small), Error);
  EXPECT_NO_THROW(lay(40, nullptr));
}

TEST(Comparison, GreyAgainstColourIsLuminance) {
  LinearPicture grey = picture(16, 16, false);
  io::Image y(16, 16, {"Y"});
  for (std::size_t p = 0; p < y.pixels(); ++p)
    y.data[p] = 0.2126f * grey.colour.data[3 * p] + 0.7152f * grey.colour.data[3 * p + 1] +
                0.0722f * grey.colour.data[3 * p + 2];
  grey.colour = y;
  const Measures m = measure(lay_over("pair", grey, picture(16, 16, false), nullptr, Channels::all, {}), {});
  EXPECT_NEAR(m.rmse->value, 0, 1e-7);
}

TEST(Comparison, LimitsAreHeld) {
  Measures m;
  m.rmse = Estimate{0.02, 0.001};
  m.ssim = Estimate{0.9, 0.01};
  EXPECT_TRUE(violations(m, {}).empty());
  EXPECT_TRUE(violations(m, {.max_rmse = 0.02, .min_ssim = 0.9}).empty());
  EXPECT_EQ(violations(m, {.max_rmse = 0.01, .min_ssim = 0.95}).size(), 2u);
  EXPECT_EQ(violations(m, {.max_z_rms = 2}).size(), 1u);  // undefined, and a limit was set
}

TEST(DifferencePictures, SplitTheSign) {
  LinearPicture rendering = picture(2, 1, false);
  rendering.colour.at(0, 0, 0) += 0.1f;
  rendering.colour.at(1, 0, 1) -= 0.05f;
  const Overlay o = lay_over("pair", picture(2, 1, false), std::move(rendering), nullptr, Channels::all, {});
  const Differences d = differences(o, 1);
  const io::Image bright = positive_part(o, d, 0.1), dark = negative_part(o, d, 0.1);
  EXPECT_NEAR(bright.at(0, 0, 0), 1, 1e-4);
  EXPECT_EQ(bright.at(1, 0, 1), 0);
  EXPECT_NEAR(dark.at(1, 0, 1), std::pow(0.5, 1 / 2.2), 1e-4);
  EXPECT_EQ(dark.at(0, 0, 0), 0);
}

}  // namespace
}  // namespace gonio::metric
