// One edge: closed forms, and uncertainties that hold over thousands of edges sampled as edges() samples them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "base/random.h"
#include "volume/phantoms.h"
#include "volume/sampling.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

double step_share(double x, double w) {
  return 0.5 * std::erfc(x / (w * std::sqrt(2.0)));
}
std::vector<double> line(double first, double last, double step = 0.5) {
  std::vector<double> s;
  for (double x = first; x <= last + 1e-9; x += step) s.push_back(x);
  return s;
}
Vec3 direction(Random& random) {
  const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

TEST(EdgeFit, TheModelsOwnValuesComeBackExactly) {
  for (const double p : {-1.1, -0.3, 0.0, 0.7, 1.2})
    for (const double w : {0.45, 0.8, 1.3}) {
      const auto s = line(-3, 3);
      std::vector<double> v;
      for (const double x : s) v.push_back(12 + 80 * step_share(x - p, w));
      const Edge e = fit_edge(s, v, 1);
      EXPECT_TRUE(e.good) << p << " " << w;
      EXPECT_NEAR(e.position, p, 1e-4);
      EXPECT_NEAR(e.width, w, 1e-4);
      EXPECT_NEAR(e.air, 12, 0.02);
      EXPECT_NEAR(e.object, 92, 0.02);
      EXPECT_LT(e.misfit, 1e-4);
    }
}

TEST(EdgeFit, AnEdgeThatRisesOutwardsIsFittedTooAndSaysSo) {
  const auto s = line(-3, 3);
  std::vector<double> v;
  for (const double x : s) v.push_back(5 - 4 * step_share(x - 0.2, 0.8));
  const Edge e = fit_edge(s, v, 0.01);
  EXPECT_TRUE(e.good);
  EXPECT_NEAR(e.position, 0.2, 1e-4);
  EXPECT_LT(e.object, e.air);
}

TEST(EdgeFit, TheCurvatureOfABallIsNoShift) {
  for (const double radius : {4.0, 8.0, 30.0})
    for (const double w : {0.7, 1.0}) {
      const auto s = line(-3, 3);
      std::vector<double> v;
      for (const double x : s) v.push_back(phantom::ball({radius + x, 0, 0}, {}, radius, w));
      ProfileWish wish{0.01};
      const double without = fit_edge(s, v, wish).position;
      wish.mean_curvature = 1 / radius;
      const Edge with = fit_edge(s, v, wish);
      EXPECT_NEAR(without, -w * w / radius, 0.3 * w * w / radius) << "the shift that Bouma et al. foretell";
      EXPECT_NEAR(with.position, 0, 0.002) << radius << " " << w;
    }
}

TEST(EdgeFit, AThinWallIsTwoEdges) {
  for (const double thickness : {1.8, 2.5, 3.2}) {
    const auto s = line(-5, 3);
    std::vector<double> v;
    for (const double x : s) v.push_back(1 + 10 * (step_share(x - 0.2, 0.8) - step_share(x - 0.2 + thickness, 0.8)));
    ProfileWish wish{0.05};
    wish.inner = -thickness;
    const Edge both = fit_edge(s, v, wish);
    EXPECT_TRUE(both.good);
    EXPECT_NEAR(both.position, 0.2, 0.01) << thickness;
    // Cut in the middle of the wall, where no plateau is.
    const auto short_s = line(-thickness / 2, 3, 0.25);
    std::vector<double> short_v;
    for (const double x : short_s) short_v.push_back(1 + 10 * (step_share(x - 0.2, 0.8) - step_share(x - 0.2 + thickness, 0.8)));
    const Edge alone = fit_edge(short_s, short_v, 0.05);
    EXPECT_GT(std::abs(alone.position - 0.2), 3 * std::abs(both.position - 0.2)) << thickness;
  }
}

TEST(EdgeFit, WhatIsNoEdgeIsNotGood) {
  const auto s = line(-3, 3);
  EXPECT_FALSE(fit_edge(s, std::vector<double>(s.size(), 7.0), 1).good);
  Random random(3);
  int good = 0;
  for (int n = 0; n < 200; ++n) {
    std::vector<double> v;
    for (std::size_t i = 0; i < s.size(); ++i) v.push_back(random.normal());
    good += fit_edge(s, v, 1).good ? 1 : 0;
  }
  EXPECT_LT(good, 20);
  std::vector<double> broken(s.size(), 1.0);
  broken[3] = std::nan("");
  EXPECT_FALSE(fit_edge(s, broken, 1).good);
  EXPECT_FALSE(fit_edge(std::span(s).first(4), std::span(broken).first(4), 1).good);
}

TEST(EdgeFit, TheCovarianceOfSamplesIsThatOfNoiseThatWasDrawn) {
  constexpr double q = 0.4;
  const Vec3 first{5.3, 6.1, 5.8}, step = normalized({0.3, -0.5, 0.7}) * 0.5;
  constexpr std::size_t n = 7;
  const auto foretold = trilinear_covariance(first, step, n, q);
  std::vector<double> drawn(n * n);
  constexpr int repeats = 1500;
  for (int r = 0; r < repeats; ++r) {
    const auto data = phantom::sampled({14, 14, 14}, [](Vec3) { return 0.0; }, 1, q, 100 + r);
    const Block block{data.values.data(), {14, 14, 14}, {}, {}, {13, 13, 13}};
    std::vector<double> v;
    for (std::size_t i = 0; i < n; ++i) v.push_back(block.at(first + step * static_cast<double>(i)));
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) drawn[a * n + b] += v[a] * v[b] / repeats;
  }
  for (std::size_t k = 0; k < n * n; ++k) EXPECT_NEAR(drawn[k], foretold[k], 0.09) << k;
}

// Edges of walls in random directions, sampled from voxels with noise: how often is the wall within 1.96 sigma?
struct Coverage {
  double share = 0, bias = 0, rms = 0, sigma = 0;
  int good = 0;
};
Coverage coverage(int count, double thickness, double noise, double q, bool noise_is_known, std::uint64_t seed) {
  Random random(seed);
  constexpr double w = 0.7;
  constexpr std::size_t n = 20;
  Coverage result;
  for (int r = 0; r < count; ++r) {
    // Thin walls are told less by their profile than by what is known beforehand, which therefore is as uncertain here
    // as it is said to be.
    const double air_differs = 1.5 * random.normal(), width_differs = 0.07 * random.normal();
    const Vec3 d = direction(random), at{9.5 + random.uniform(-0.5, 0.5), 9.5 + random.uniform(-0.5, 0.5), 9.5};
    const auto data = phantom::sampled(
        {n, n, n},
        [&](Vec3 p) {
          const double behind = thickness > 0 ? phantom::half_space(p, at - d * thickness, d, w) : 0;
          return 1 + 10 * phantom::half_space(p, at, d, w) - (10 + air_differs) * behind;
        },
        10 * noise, q, seed + 1000 + r);
    const Block block{data.values.data(), {n, n, n}, {}, {}, {n - 1.0, n - 1.0, n - 1.0}};
    const double off = random.uniform(-0.4, 0.4);
    const auto s = line(thickness > 0 ? -5 : -3, 3);
    std::vector<double> v;
    for (const double x : s) v.push_back(block.at(at + d * (x + off)));
    const auto covariance = trilinear_covariance(at + d * (s[0] + off), d * 0.5, s.size(), q);
    ProfileWish wish{noise_is_known ? 10 * noise : 0, covariance};
    if (thickness > 0) {
      wish.inner = -thickness;
      wish.width = std::sqrt(w * w + 1.0 / 6) * std::exp(width_differs);
    }
    const Edge e = fit_edge(s, v, wish);
    if (!e.good) continue;
    const double error = e.position + off;
    ++result.good;
    result.share += std::abs(error) < 1.96 * e.sigma ? 1 : 0;
    result.bias += error, result.rms += error * error, result.sigma += e.sigma;
  }
  result.share /= result.good, result.bias /= result.good, result.sigma /= result.good;
  result.rms = std::sqrt(result.rms / result.good);
  std::printf("thickness %.1f noise %.3f q %.1f: %d good, coverage %.4f bias %+.4f rms %.4f sigma %.4f\n", thickness, noise,
              q, result.good, result.share, result.bias, result.rms, result.sigma);
  return result;
}

// 400 edges each (2,000 on request: GONIO_WHOLE=1). Binomial: 95 % +- 3.3 % at three sigma, 1.5 % for the whole.
TEST(EdgeFit, StatedUncertaintiesHold) {
  const bool whole = std::getenv("GONIO_WHOLE") != nullptr;
  const int count = whole ? 2000 : 300;
  const double slack = whole ? 0.02 : 0.045;
  for (const double thickness : {0.0, 2.5})
    for (const double q : {0.0, 0.5}) {
      const Coverage c = coverage(count, thickness, 0.05, q, true, 17);
      EXPECT_GT(c.good, 0.99 * count);
      EXPECT_NEAR(c.share, 0.95, slack) << thickness << " " << q;
      EXPECT_LT(std::abs(c.bias), 4 * c.rms / std::sqrt(count) + 0.005) << thickness << " " << q;
      EXPECT_LT(c.rms, 0.1);
    }
}

}  // namespace
}  // namespace gonio::volume
