// explain on height maps: isotropic fields, gratings and lays that were put in, and the recorded ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "explain/engine.h"
#include "explain/heights/heights_problem.h"
#include "explain/heights/tile_spectra.h"
#include "geom/vector.h"
#include "inference/explanation.h"

namespace gonio::explain::tests {
namespace {

// The same spectrum in all directions: a Gaussian filter, which separates.
io::HeightMap isotropic_map(std::uint64_t seed, std::size_t side = 320) {
  io::HeightMap map{side, side, 0.5e-6, 0.5e-6, std::vector<double>(side * side)};
  std::vector<double> white(side * side), half(side * side);
  Random random(seed, 12);
  for (double& z : white) z = 1e-7 * random.normal();
  constexpr int reach = 6;
  constexpr double width = 1.6;
  const auto at = [&](const std::vector<double>& z, long x, long y) {
    const auto n = static_cast<long>(side);
    return z[static_cast<std::size_t>((y + n) % n * n + (x + n) % n)];
  };
  for (long y = 0; y < static_cast<long>(side); ++y)
    for (long x = 0; x < static_cast<long>(side); ++x)
      for (int k = -reach; k <= reach; ++k)
        half[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)] +=
            std::exp(-0.5 * k * k / (width * width)) * at(white, x + k, y);
  for (long y = 0; y < static_cast<long>(side); ++y)
    for (long x = 0; x < static_cast<long>(side); ++x)
      for (int k = -reach; k <= reach; ++k)
        map.z_m[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)] +=
            std::exp(-0.5 * k * k / (width * width)) * at(half, x, y + k);
  for (std::size_t i = 0; i < map.z_m.size(); ++i) map.z_m[i] += 3e-9 * random.normal();  // the instrument's own
  return map;
}

void add_grating(io::HeightMap& map, double period_m, double azimuth_rad, double amplitude_m) {
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x) {
      const double u = std::cos(azimuth_rad) * static_cast<double>(x) * map.step_x_m +
                       std::sin(azimuth_rad) * static_cast<double>(y) * map.step_y_m;
      map.z_m[y * map.width + x] += amplitude_m * std::cos(2 * pi * u / period_m + 0.4);
    }
}

struct Answer {
  std::unique_ptr<Problem> problem;
  Explanation e;
  std::vector<std::string> named;
  const Estimate* estimate(const std::string& name) const {
    for (const Estimate& x : e.estimates)
      if (problem->parameters()[x.parameter].name == name) return &x;
    return nullptr;
  }
};
Answer explained(io::HeightMap map) {
  Answer a{
      heights_problem({.table = "t", .surface = "", .place = "t.json", .map = std::move(map), .ridges = {}, .lay = {}}),
      {},
      {}};
  a.e = explain(*a.problem, {.negative_controls = 8});
  for (const std::size_t c : a.e.named) a.named.push_back(a.problem->candidates()[c].id());
  return a;
}

// White noise of variance s^2 has the density s^2 dx dy at every frequency; ln P lies 0.5772 below with 1.28 about it.
TEST(TileSpectra, OfWhiteNoise) {
  io::HeightMap map{256, 256, 2e-6, 1e-6, std::vector<double>(65536)};
  Random random(3);
  for (double& z : map.z_m) z = 1e-8 * random.normal();
  const heights::TileSpectra s = heights::tile_spectra(map, "t");
  double sum = 0, squares = 0, n = 0;
  for (const heights::Tile& tile : s.judged)
    for (const double log_power : tile.log_power) {
      const double z = log_power - std::log(1e-16 * 2e-6 * 1e-6);
      sum += z, squares += z * z, n += 1;
    }
  const double mean = sum / n, sigma = std::sqrt(squares / n - mean * mean);
  EXPECT_NEAR(mean, -heights::euler_gamma, 0.05);
  EXPECT_NEAR(sigma, heights::log_sigma, 0.05);
}

// A line on a bin has the power that line_gain() says, and the window's three.
TEST(TileSpectra, OfALine) {
  io::HeightMap map{256, 256, 1e-6, 1e-6, std::vector<double>(65536, 0.0)};
  const heights::TileSpectra empty = heights::tile_spectra(map, "t");
  const double period = static_cast<double>(empty.n) * 1e-6 / 8;
  add_grating(map, period, 0, 2e-8);
  const heights::TileSpectra s = heights::tile_spectra(map, "t");
  for (std::size_t i = 0; i < s.ordinates.size(); ++i) {
    const heights::Ordinate& o = s.ordinates[i];
    if (o.ky != 0 || o.kx < 7 || o.kx > 9) continue;
    const double expected = s.line_gain() * 4e-16 * std::pow(heights::hann_response(o.kx - 8), 2);
    EXPECT_NEAR(std::exp(s.judged[0].log_power[i]) / expected, 1, 0.02) << o.kx;
  }
}

TEST(Heights, AGratingIsFoundAsAPeriodAndADirection) {
  const double period = 7.3e-6, azimuth = 0.6, amplitude = 1e-7;
  io::HeightMap map = isotropic_map(1);
  add_grating(map, period, azimuth, amplitude);
  const Answer a = explained(std::move(map));
  ASSERT_THAT(a.named, testing::ElementsAre("surface.micro-ridges")) << a.e.sentence;
  const Estimate *p = a.estimate("surface.micro-ridges.ridge_period_m"),
                 *d = a.estimate("surface.micro-ridges.ridge_azimuth_rad"),
                 *h = a.estimate("surface.micro-ridges.ridge_amplitude_m");
  EXPECT_NEAR(p->value, period, 3.5 * p->sigma);
  EXPECT_LT(p->sigma, 0.02 * period);
  EXPECT_NEAR(std::remainder(d->value - azimuth, pi), 0, 3.5 * d->sigma);
  EXPECT_NEAR(h->value, amplitude, 0.1 * amplitude);
  EXPECT_THAT(a.e.sentence, testing::HasSubstr("Ridges repeat every 7."));
  EXPECT_LT(a.e.held_out_after, a.e.held_out_before);
}

TEST(Heights, ALayIsFoundWithItsDirection) {
  io::HeightMap map = isotropic_map(2);
  map.step_x_m *= 1.3;  // features 1.3 times as long along the rows
  const Answer a = explained(std::move(map));
  ASSERT_THAT(a.named, testing::ElementsAre("surface.anisotropy")) << a.e.sentence;
  const Estimate *a0 = a.estimate("surface.anisotropy.anisotropy_0"),
                 *a45 = a.estimate("surface.anisotropy.anisotropy_45");
  EXPECT_NEAR(a0->value, -0.5 * std::log(1.3), 3.5 * a0->sigma + 0.01);
  EXPECT_NEAR(a45->value, 0, 3.5 * a45->sigma + 0.01);
}

// A line stands out of a roughness with a lay, along which all is rough.
TEST(Heights, AGratingIsFoundBesideALay) {
  io::HeightMap map = isotropic_map(3);
  map.step_x_m *= 1.7;
  add_grating(map, 6.1e-6, 1.45, 1e-7);
  const Answer a = explained(std::move(map));
  ASSERT_THAT(a.named, testing::UnorderedElementsAre("surface.anisotropy", "surface.micro-ridges")) << a.e.sentence;
  const Estimate *p = a.estimate("surface.micro-ridges.ridge_period_m"),
                 *a0 = a.estimate("surface.anisotropy.anisotropy_0");
  EXPECT_NEAR(p->value, 6.1e-6, 3.5 * p->sigma);
  EXPECT_NEAR(a0->value, -0.5 * std::log(1.7), 3.5 * a0->sigma + 0.01);
  EXPECT_THAT(a.e.sentence, testing::Not(testing::HasSubstr("row_variance")));  // none is no limit of the plausible
}

// Ten isotropic maps; names at 1 % each: two or more in 0.4 % of such tests.
TEST(Heights, NothingIsNamedOnIsotropicMaps) {
  int names = 0;
  for (std::uint64_t seed = 20; seed < 30; ++seed) names += !explained(isotropic_map(seed, 192)).named.empty();
  EXPECT_LE(names, 1);
}

TEST(Heights, GapsAreBridgedAndSmallMapsRefused) {
  io::HeightMap map = isotropic_map(3, 256);
  for (std::size_t i = 0; i < 40; ++i) map.z_m[i * 97] = std::nan("");
  const heights::TileSpectra s = heights::tile_spectra(map, "t");
  for (const heights::Tile& tile : s.judged)
    for (const double p : tile.log_power) ASSERT_TRUE(std::isfinite(p));
  EXPECT_THROW(heights::tile_spectra(isotropic_map(3, 60), "t"), Error);
}

// Tracks of a CD are 1.5 to 1.7 um apart (IEC 60908); the file's comment says "China CD stamper".
TEST(RecordedHeights, ADiscsTracksAreAGrating) {
  GONIO_NEEDS_DATA("surface");
  const Answer a = explained(io::read_height_map(gonio::tests::data("surface/test_uncompressed.sur")));
  ASSERT_THAT(a.named, testing::Contains("surface.micro-ridges")) << a.e.sentence;
  const Estimate *p = a.estimate("surface.micro-ridges.ridge_period_m"),
                 *d = a.estimate("surface.micro-ridges.ridge_azimuth_rad");
  EXPECT_NEAR(p->value, 1.6e-6, 0.1e-6);
  EXPECT_LT(p->sigma, 0.02e-6);
  EXPECT_NEAR(d->value * 180 / pi, -10, 3);
}

}  // namespace
}  // namespace gonio::explain::tests
