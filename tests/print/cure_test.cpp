#include "print/cure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "print/prediction.h"

namespace gonio::print {
namespace {

constexpr double um = 1e-6;
const GrowthLaw law{17.71 * um, 10.24 * um, -0.01};  // of the thesis

// Against sums over a fine grid of the kernel itself.
TEST(Bleed, AtAPointIsTheIntegralOverThePixel) {
  const Bleed bleed{8 * um, 0.1, 25 * um};
  const Vec2 pixel{15 * um, 12 * um};
  for (const Vec2 offset : {Vec2{0, 0}, Vec2{5 * um, -3 * um}, Vec2{31 * um, 12 * um}, Vec2{-200 * um, 90 * um}}) {
    double sum = 0;
    constexpr int side = 400;
    for (int k = 0; k < side * side; ++k) {
      const double x = offset.x + ((k % side + 0.5) / side - 0.5) * pixel.x,
                   y = offset.y + ((k / side + 0.5) / side - 0.5) * pixel.y;
      const double r2 = x * x + y * y, s2 = bleed.sigma_m * bleed.sigma_m, w2 = bleed.tail_m * bleed.tail_m;
      sum += (1 - bleed.tail_share) * std::exp(-r2 / (2 * s2)) / (2 * pi * s2) +
             bleed.tail_share * std::pow(1 + r2 / w2, -1.5) / (2 * pi * w2);
    }
    sum *= pixel.x * pixel.y / (side * side);
    EXPECT_NEAR(bleed.at(offset, pixel), sum, 2e-5 * sum + 1e-12) << offset.x;
  }
}

TEST(Bleed, AllPixelsTogetherGetTheLight) {
  const Bleed bleed{8 * um, 0.1, 10 * um};
  const Vec2 pixel{15 * um, 15 * um};
  double sum = 0;
  constexpr int far = 1500;  // beyond a radius r there is w / r of the tail
  for (int j = -far; j <= far; ++j)
    for (int i = -far; i <= far; ++i) sum += bleed.at({(i + 0.3) * pixel.x, (j - 0.2) * pixel.y}, pixel);
  EXPECT_NEAR(sum, 1, 0.1 * 10 / (far * 15) * 1.2);
}

std::vector<float> random_light(int pixels, std::uint64_t seed) {
  Random random(seed, 1);
  std::vector<float> light(static_cast<std::size_t>(pixels));
  for (float& v : light) v = static_cast<float>(random.uniform());
  return light;
}

// With a tail, by Fourier transforms; a core alone, along rows and columns.
class Spreads : public testing::TestWithParam<double> {};
TEST_P(Spreads, AreSumsOverAllPixels) {
  const Bleed bleed{8 * um, GetParam(), 25 * um};
  const Vec2 pixel{15 * um, 12 * um}, offset{0.25, -0.25};
  constexpr int wide = 13, high = 9;
  const std::vector<float> light = random_light(wide * high, 5);
  std::vector<float> spread(light.size());
  Spread(bleed, pixel, wide, high, offset)(light, spread);
  for (int y = 0; y < high; ++y)
    for (int x = 0; x < wide; ++x) {
      double sum = 0;
      for (int j = 0; j < high; ++j)
        for (int i = 0; i < wide; ++i)
          sum += static_cast<double>(light[static_cast<std::size_t>(j * wide + i)]) *
                 bleed.at({(x - i + offset.x) * pixel.x, (y - j + offset.y) * pixel.y}, pixel);
      EXPECT_NEAR(spread[static_cast<std::size_t>(y * wide + x)], sum, 2e-6);
    }
}

TEST_P(Spreads, AreTransposedBackwards) {
  const Spread spread({8 * um, GetParam(), 25 * um}, {15 * um, 12 * um}, 17, 11, {0.1, 0.3});
  const std::vector<float> a = random_light(17 * 11, 1), b = random_light(17 * 11, 2);
  std::vector<float> ka(a.size()), kb(b.size());
  spread(a, ka), spread.backwards(b, kb);
  const double forward = std::inner_product(ka.begin(), ka.end(), b.begin(), 0.0);
  EXPECT_NEAR(forward, std::inner_product(a.begin(), a.end(), kb.begin(), 0.0), 1e-5 * forward);
}
INSTANTIATE_TEST_SUITE_P(Tails, Spreads, testing::Values(0.0, 0.1));

Printer printer_with(const Growth& growth, double layer_m = 18 * um) {
  Printer p;
  p.name = p.place = "p";
  p.width_px = p.height_px = 8, p.pixel_m = {15 * um, 15 * um}, p.layer_m = layer_m, p.growth = growth;
  return p;
}
std::vector<std::vector<float>> even(std::initializer_list<double> greys) {
  std::vector<std::vector<float>> layers;
  for (const double grey : greys) layers.emplace_back(64, static_cast<float>(grey));
  return layers;
}

TEST(Cure, AColumnGrowsAsTheLawSays) {
  const Printer p = printer_with(Growth(law));
  const CuredSurface s = cured(p, {0, 0, 8, 8}, even({1, 1, 0.5}), 0, 2);
  ASSERT_EQ(s.width, 16);
  EXPECT_NEAR(s.step_m.x, 7.5 * um, 1e-15);
  EXPECT_NEAR(s.first_m.x, -56.25 * um, 1e-12);
  for (const float z : s.top_m) EXPECT_NEAR(z, 36 * um + law.height_m(static_cast<double>(0.5f)), 1e-10);
  for (const float z : s.underside_m) EXPECT_NEAR(z, 0, 1e-12);
}

TEST(Cure, NoVoxelGrowsThroughTheMembrane) {
  const Printer p = printer_with(Growth(law), 10 * um);
  for (const float z : cured(p, {0, 0, 8, 8}, even({1, 1}), 0).top_m) EXPECT_NEAR(z, 20 * um, 1e-11);
}

// Three white layers over three dark ones: what is solid below them follows from the sum of what goes through.
TEST(Cure, LightThatGoesThroughHangsBelow) {
  Printer p = printer_with(Growth(law));
  p.overcure_m = 30 * um;
  const CuredSurface s = cured(p, {0, 0, 8, 8}, even({0, 0, 0, 1, 1, 1}), 0);
  const double kept = std::exp(-18.0 / 30), sum = kept + kept * kept + kept * kept * kept;
  double below = 54 * um, light = sum;
  for (int layer = 2; layer >= 0; --layer, light *= kept)
    if (const double h = std::min(18 * um, law.height_m(light)); h > 0) below = (layer + 1) * 18 * um - h;
  EXPECT_LT(below, 40 * um);
  for (const float z : s.underside_m) EXPECT_NEAR(z, below, 1e-10);
  for (const float z : s.top_m) EXPECT_NEAR(z, 5 * 18 * um + law.height_m(1), 1e-10);
}

TEST(Cure, WhatNothingLightsIsNoSurface) {
  const Printer p = printer_with(Growth(law));
  for (const float z : cured(p, {0, 0, 8, 8}, even({0.1, 0.1}), 0).top_m) EXPECT_TRUE(std::isnan(z));
}

TEST(Cure, IsTheSameForAnyNumberOfThreads) {
  Printer p = printer_with(Growth(law));
  p.bleed = {8 * um, 0.05, 30 * um}, p.overcure_m = 10 * um;
  const std::vector<std::vector<float>> layers{random_light(64, 1), random_light(64, 2), random_light(64, 3)};
  set_threads(1);
  const CuredSurface one = cured(p, {0, 0, 8, 8}, layers, 0, 3);
  set_threads(3);
  const CuredSurface three = cured(p, {0, 0, 8, 8}, layers, 0, 3);
  set_threads(0);
  EXPECT_EQ(std::memcmp(one.top_m.data(), three.top_m.data(), one.top_m.size() * sizeof(float)), 0);
}

TEST(Growth, GreysAndHeightsAreInverse) {
  const GrowthTable table({0, 0.2, 0.5, 1}, {0, 1 * um, 9 * um, 16 * um}, std::vector<double>(4, 1.0));
  for (const Growth& growth : {Growth(), Growth(law), Growth(law, table)}) {
    for (int k = 1; k <= 15; ++k) {
      const double h = k * um;
      EXPECT_NEAR(growth.height_m(growth.grey(h, 18 * um), 18 * um), h, 1e-10);
      const double grey = growth.grey(h, 18 * um), step = 1e-5;
      EXPECT_NEAR(growth.slope_m(grey, 18 * um),
                  (growth.height_m(grey + step, 18 * um) - growth.height_m(grey - step, 18 * um)) / (2 * step),
                  0.05 * um);
    }
    EXPECT_EQ(growth.grey(0, 18 * um), 0);
    EXPECT_EQ(growth.height_m(growth.threshold(), 18 * um), 0);
  }
}

// The published ground noise moves heights within the voxel, and no further.
TEST(Prediction, GroundStaysWithinTheVoxel) {
  const Printer p = printer_with(Growth(law));
  CuredSurface s = cured(p, {0, 0, 8, 8}, even({1, 0.5}), 0, 8);
  const double level = 18 * um + law.height_m(static_cast<double>(0.5f));
  add_ground(s, published_ground());
  double sum = 0;
  for (const float z : s.top_m) {
    EXPECT_GE(z, 18 * um - 1e-11);
    EXPECT_LE(z, 36 * um + 1e-11);
    sum += (z - level) * (z - level);
  }
  const double rms = std::sqrt(sum / static_cast<double>(s.top_m.size()));
  EXPECT_GT(rms, 0.5 * um);
  EXPECT_LT(rms, 5 * um);
}

TEST(Prediction, MapAndMeshShowTheSurface) {
  Printer p = printer_with(Growth());
  std::vector<std::vector<float>> layers(1, std::vector<float>(64, 0));
  for (int y = 2; y < 6; ++y)
    for (int x = 1; x < 7; ++x) layers[0][static_cast<std::size_t>(8 * y + x)] = static_cast<float>(y) / 8;
  const CuredSurface s = cured(p, {0, 0, 8, 8}, layers, 0);
  const io::HeightMap map = height_map_of(s);
  EXPECT_NEAR(map.at(3, 7 - 5), 18 * um * 5 / 8, 1e-11);  // rows from the top, y upwards
  EXPECT_TRUE(std::isnan(map.at(0, 0)));
  const io::TriangleMesh mesh = mesh_of(s);
  EXPECT_EQ(mesh.positions_m.size(), 24u);
  EXPECT_EQ(mesh.triangles.size(), 2u * 5 * 3);
  for (const auto& [a, b, c] : mesh.triangles)
    EXPECT_GT(cross(mesh.positions_m[b] - mesh.positions_m[a], mesh.positions_m[c] - mesh.positions_m[a]).z, 0);
}

}  // namespace
}  // namespace gonio::print
