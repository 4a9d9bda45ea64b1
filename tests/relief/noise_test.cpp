// Sparse convolution noise against its derived moments, and ground noise that was put into maps.
#include "relief/noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "relief/areal.h"
#include "relief/ground_noise.h"

namespace gonio::relief {
namespace {

// C(0) = (pi / 4) B(3/2, 7) with B(3/2, 7) = Gamma(3/2) Gamma(7) / Gamma(17/2).
TEST(Noise, ItsSigmaIsTheDerivedOne) {
  const double c0 = pi / 4 * std::tgamma(1.5) * std::tgamma(7) / std::tgamma(8.5);
  EXPECT_NEAR(noise_sigma(), 4 / (5 * std::cbrt(30.0)) * std::sqrt(10 * c0), 2e-5);
  EXPECT_NEAR(noise_correlation(0), 1, 1e-12);
  EXPECT_EQ(noise_correlation(1), 0);
  // 2000 independent places: mean within 4 sigmas, variance (kurtosis near 3) within 4 sqrt(2.2 / 2000)
  double sum = 0, squares = 0, lag = 0;
  const SparseNoise noise(11);
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p{7.0 * k + random.uniform(), random.uniform(-50, 50), random.uniform(-50, 50)};
    const double v = noise(p), w = noise(p + Vec3{0.3, 0, 0});
    sum += v, squares += v * v, lag += v * w;
  }
  const double s2 = noise_sigma() * noise_sigma();
  EXPECT_NEAR(sum / 2000, 0, 4 * noise_sigma() / std::sqrt(2000));
  EXPECT_NEAR(squares / 2000, s2, 4 * s2 * std::sqrt(2.2 / 2000));
  EXPECT_NEAR(lag / 2000, noise_correlation(0.3) * s2, 4 * s2 * std::sqrt(2.0 / 2000));
  EXPECT_EQ(noise({1.2, 3.4, -5.6}), SparseNoise(11)({1.2, 3.4, -5.6}));
  EXPECT_NE(noise({1.2, 3.4, -5.6}), SparseNoise(12)({1.2, 3.4, -5.6}));
}

TEST(Noise, PeriodicReliefsClose) {
  const SparseNoise noise(4, {5, 7, 0});
  EXPECT_NEAR(noise({0.7, 6.9, 0.5}), noise({5.7, -0.1, 0.5}), 1e-15);
  const NoiseField field{.parts = {{1e-6, 9.7e-6}}, .nx = 96, .ny = 64, .step_m = 1e-6, .seed = 3, .periodic = true};
  const Relief r = noise_relief(field);
  double across = 0, inside = 0;
  for (int j = 0; j < 64; ++j) {
    across = std::max(across, std::abs(r.z_m(0, j) - r.z_m(95, j)));
    for (int i = 0; i + 1 < 96; ++i) inside = std::max(inside, std::abs(r.z_m(i, j) - r.z_m(i + 1, j)));
  }
  EXPECT_LT(across, 1.5 * inside);
  EXPECT_THROW(noise_relief({.parts = {}}), Error);
}

io::HeightMap printed(std::uint64_t seed, int side, double white_m) {
  io::HeightMap map = map_of(
      noise_relief({.parts = {{1e-6, 16e-6}, {0.25e-6, 4e-6}}, .nx = side, .ny = side, .step_m = 1e-6, .seed = seed}));
  Random random(seed, 9);
  for (double& z : map.z_m) z += white_m * random.normal();
  return map;
}

// 14 maps: intervals of 1.96 sigma that cover with 95 % do so in 10 of them or more with probability 0.9996.
TEST(GroundNoise, IntervalsCoverWhatWasPutIn) {
  int coarse_sq = 0, coarse_cell = 0, fine_sq = 0, fine_cell = 0, white = 0;
  double misfit = 0;
  for (std::uint64_t k = 0; k < 14; ++k) {
    const GroundNoise g = fit_ground_noise({printed(k, 256, 2e-8)}, {"t"}, {.parts = 2});
    ASSERT_EQ(g.parts.size(), 2u);
    const auto in = [](double value, double sigma, double truth) { return std::abs(value - truth) < 1.96 * sigma; };
    coarse_sq += in(g.parts[0].sq_m, g.parts[0].sigma_sq_m, 1e-6);
    coarse_cell += in(g.parts[0].cell_m, g.parts[0].sigma_cell_m, 16e-6);
    fine_sq += in(g.parts[1].sq_m, g.parts[1].sigma_sq_m, 0.25e-6);
    fine_cell += in(g.parts[1].cell_m, g.parts[1].sigma_cell_m, 4e-6);
    white += in(g.white_m, g.sigma_white_m, 2e-8);
    EXPECT_LT(g.parts[0].sigma_sq_m, 0.1e-6);
    EXPECT_LT(g.parts[1].sigma_cell_m, 0.3e-6);
    misfit += g.misfit / 14;
  }
  EXPECT_GE(coarse_sq, 10);
  EXPECT_GE(coarse_cell, 10);
  EXPECT_GE(fine_sq, 10);
  EXPECT_GE(fine_cell, 10);
  EXPECT_GE(white, 10);
  EXPECT_NEAR(misfit, 1, 0.15);
}

TEST(GroundNoise, TheNumberOfPartsIsFound) {
  const GroundNoise two = fit_ground_noise({printed(40, 192, 2e-8)}, {"t"});
  EXPECT_EQ(two.parts.size(), 2u);
  EXPECT_GT(two.criterion[0], 10);
  io::HeightMap one = map_of(noise_relief({.parts = {{1e-6, 8e-6}}, .nx = 192, .ny = 192, .step_m = 1e-6, .seed = 4}));
  Random random(5);
  for (double& z : one.z_m) z += 1e-8 * random.normal();
  EXPECT_EQ(fit_ground_noise({one}, {"t"}).parts.size(), 1u);
  EXPECT_THROW(fit_ground_noise({printed(1, 40, 1e-8)}, {"t"}), Error);
}

}  // namespace
}  // namespace gonio::relief
