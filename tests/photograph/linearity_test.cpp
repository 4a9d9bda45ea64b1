// Linearity tables: read, refused, and found in series of simulated sensors with a known curve, within their intervals;
// not found where the sensor is linear.
#include "photograph/linearity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/picture.h"
#include "photograph/raw_view.h"
#include "photograph/sensor_linearity.h"
#include "photograph/sensor_series.h"

namespace gonio::photograph {
namespace {

TEST(Linearity, IsReadAndInterpolated) {
  const tests::ScratchFolder folder;
  write_file(folder / "t.csv", "code,linear\n0,0\n1000,900\n3000,3100\n");
  const Linearity t = read_linearity(folder / "t.csv");
  EXPECT_DOUBLE_EQ(t(500), 450);
  EXPECT_DOUBLE_EQ(t(2000), 2000);
  EXPECT_DOUBLE_EQ(t(-10), -9);
  EXPECT_DOUBLE_EQ(t(3100), 3210);
  for (const double code : {-20.0, 0.0, 400.0, 1000.0, 2900.0, 3100.0}) EXPECT_NEAR(t.code_of(t(code)), code, 1e-9);
  EXPECT_DOUBLE_EQ(t.slope(10), 0.9);
  EXPECT_DOUBLE_EQ(t.slope(1000), 1.0);
  // Shot noise of 2 electrons per code and read noise of 3 codes, through the slope.
  const NoiseModel noise = t.noise({2, 3}, 3100);
  EXPECT_NEAR(noise_variance(noise, 450), 0.81 * (250 + 9), 1);
  EXPECT_NEAR(noise_variance(noise, 2000), 1.21 * (1000 + 9), 1);
  EXPECT_NEAR(noise_variance(noise, -50), 0.81 * 9, 1e-9);
}

TEST(Linearity, WhatIsNoTableIsRefused) {
  const tests::ScratchFolder folder;
  for (const auto& [text, says] : {std::pair{"code,linear\n0,0\n", "1 row"},
                                   {"code,linear\n0,0\n10,10\n10,11\n", "code 10 behind code 10"},
                                   {"code,linear\n0,0\n10,10\n20,9\n", "linear code 9 behind 10"},
                                   {"code,linear\n5,5\n10,10\n", "begins at code 5"},
                                   {"code,light\n0,0\n10,10\n", "no columns"},
                                   {"code,linear\n0,0\n10,ten\n", "t.csv:3"}}) {
    write_file(folder / "t.csv", text);
    try {
      read_linearity(folder / "t.csv");
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_THAT(std::string(e.what()), testing::HasSubstr(says));
    }
  }
}

constexpr double gain = 0.25, read_e = 8, full = 3900;  // codes per electron, electrons, codes above black

// What a sensor reads of linear codes, and the way back.
double bent(double linear, double bend) {
  return linear * (1 - bend * linear / full);
}
double straight(double code, double bend) {
  return bend == 0 ? code : full / (2 * bend) * (1 - std::sqrt(1 - 4 * bend * code / full));
}

SensorLinearity found_in_series(double bend, double flicker, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  SensorSeries series;
  const std::vector<double> shares{0.04, 0.08, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85};
  for (const double share : shares)
    for (int k = 0; k < 2; ++k) series.frames.push_back({"lit", false, 0.01 * share});
  for (int k = 0; k < 4; ++k) series.frames.push_back({"dark", true, 0.001});
  series.read = [&](std::size_t k) {
    constexpr int side = 48;
    RawFrame f{.width = side, .height = side, .mosaic = Mosaic::named("Mono", "test")};
    f.floor = -100, f.full_scale = 3995, f.full_code = 65535;
    const double lamp = series.frames[k].dark ? 0 : series.frames[k].exposure_s / 0.01 * (1 + flicker * normal(random));
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double mean = lamp * full / gain * (1 - 0.2 * x / side),
                     electrons = mean + std::sqrt(mean) * normal(random) + read_e * normal(random);
        f.codes.push_back(static_cast<float>(std::round(bent(gain * electrons, bend))));
      }
    return f;
  };
  const SeriesSums sums = sum_series(series);
  return sensor_linearity(sums, characterize(sums));
}

// Codes with stated noise, made linear: the mean square of (found - true) / sigma is 1 for dark, middle and bright
// light, within four standard errors; the slope alone would change it by a factor of 1.5.
TEST(Linearity, TheMergesVarianceGoesThroughTheSlope) {
  const tests::ScratchFolder folder;
  constexpr double bend = 0.2;
  constexpr int width = 180, height = 100;
  const manifest::Noise noise{4, 3};
  std::vector<LinearityRow> rows;
  for (int k = 0; k <= 60; ++k) rows.push_back({50.0 * k, straight(50.0 * k, bend), 0});
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto light = [](int x) { return 30 + 2900.0 * x / width; };
  io::Image picture(width, height, {"Y"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double code = bent(light(x), bend);
      picture.at(x, y, 0) = static_cast<float>(code + std::sqrt(noise_variance(noise, code)) * normal(random));
    }
  io::write_picture(folder / "view.exr", picture);
  RawRecipe recipe;
  recipe.noise = noise;
  recipe.stated.linearity = std::make_shared<Linearity>(rows, "test");
  const DevelopedView view = develop_view({"view", {folder / "view.exr"}, {1.0}}, recipe);
  for (int part = 0; part < 3; ++part) {
    double squares = 0, count = 0;
    for (int y = 0; y < height; ++y)
      for (int x = part * width / 3; x < (part + 1) * width / 3; ++x, ++count)
        squares += std::pow(view.picture.at(x, y, 0) - light(x), 2) / view.picture.at(x, y, 1);
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 / count)) << part;
  }
}

// Of rows over the range that was seen, the share whose interval of 95 % covers the truth; rows of one series go
// together, so that the share varies over series. Scale is that at the reference. Measured over 60 series: 0.992 with a
// steady lamp (whose flicker cannot be told from noise and is taken to be as large), 0.941 with one that flickers.
TEST(SensorLinearity, AKnownCurveIsFoundWithinItsIntervals) {
  for (const double flicker : {0.0, 2e-3}) {
    double covered = 0, rows = 0, worst = 0;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
      const SensorLinearity l = found_in_series(0.08, flicker, seed);
      ASSERT_EQ(l.left_out, "");
      EXPECT_TRUE(l.significant()) << l.p;
      const double scale = l.reference / straight(l.reference, 0.08);
      for (const LinearityRow& r : l.rows) {
        if (r.code < 200) continue;
        const double off = r.linear - scale * straight(r.code, 0.08);
        covered += std::abs(off) <= 1.96 * r.sigma + 1e-9, ++rows;
        worst = std::max(worst, std::abs(off) / (scale * straight(r.code, 0.08)));
      }
    }
    EXPECT_GT(covered / rows, 0.88) << flicker;
    EXPECT_LT(worst, flicker > 0 ? 0.005 : 0.0015);
  }
}

// At p < 0.001, 40 series: more than one that shows a curve has a chance of less than 0.001.
TEST(SensorLinearity, ALinearSensorHasNone) {
  int shown = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const SensorLinearity l = found_in_series(0, seed % 2 == 0 ? 2e-3 : 0, seed);
    ASSERT_EQ(l.left_out, "");
    shown += l.significant();
  }
  EXPECT_LE(shown, 1);
}

}  // namespace
}  // namespace gonio::photograph
