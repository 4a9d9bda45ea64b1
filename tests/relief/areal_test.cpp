// Areal roughness: the recorded maps' table, known surfaces, filters, and whether the stated sigmas are honest.
#include "relief/areal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "geom/vector.h"
#include "relief/normals.h"

namespace gonio::relief {
namespace {

using io::HeightMap;

// White noise of variance 1 under a Gaussian filter of `width` points, scaled to `sq`: a piece of a periodic field that
// is so much larger that its edges know nothing of each other.
HeightMap gaussian_map(std::size_t kept, double width, double sq, std::uint64_t seed, double stretch = 1) {
  const std::size_t side = kept + static_cast<std::size_t>(8 * width * stretch);
  HeightMap map{side, side, 1e-6, 1e-6, std::vector<double>(side * side)};
  Random random(seed, 3);
  std::vector<double> z(side * side), half(side * side);
  for (double& v : z) v = random.normal();
  const auto pass = [&](const std::vector<double>& in, std::vector<double>& out, bool across, double w) {
    const auto n = static_cast<long>(side), reach = static_cast<long>(4 * w) + 1;
    double squares = 0;
    for (long k = -reach; k <= reach; ++k) squares += std::exp(-k * k / (w * w));
    for (long y = 0; y < n; ++y)
      for (long x = 0; x < n; ++x) {
        double sum = 0;
        for (long k = -reach; k <= reach; ++k) {
          const long a = across ? (x + k + n) % n : x, b = across ? y : (y + k + n) % n;
          sum += std::exp(-0.5 * k * k / (w * w)) * in[static_cast<std::size_t>(b * n + a)];
        }
        out[static_cast<std::size_t>(y * n + x)] = sum / std::sqrt(squares);
      }
  };
  pass(z, half, true, width * stretch);
  pass(half, map.z_m, false, width);
  HeightMap piece{kept, kept, 1e-6, 1e-6, {}};
  for (std::size_t y = 0; y < kept; ++y)
    for (std::size_t x = 0; x < kept; ++x) piece.z_m.push_back(sq * map.at(x, y));
  return piece;
}

TEST(Areal, RecordedMapsHaveTheRoughnessOfTheTable) {
  GONIO_NEEDS_DATA("surface");
  const auto of = [](const char* name, Levelling levelling) {
    return roughness(treated(io::read_height_map(tests::data(name)), {.levelling = levelling}, name).map);
  };
  const Roughness one = of("surface/test_1.opd", Levelling::none), two = of("surface/test_2.opd", Levelling::none);
  EXPECT_NEAR(one["Sa"].value, 1.594e-6, 0.5e-9);
  EXPECT_NEAR(one["Sq"].value, 1.927e-6, 0.5e-9);
  EXPECT_NEAR(two["Sa"].value, 0.921e-6, 0.5e-9);
  EXPECT_NEAR(two["Sq"].value, 1.165e-6, 0.5e-9);
  EXPECT_NEAR(of("surface/test_1.nms", Levelling::none)["Sq"].value, 0.719e-6, 0.5e-9);
  EXPECT_NEAR(of("surface/test_1.nms", Levelling::plane)["Sq"].value, 0.0335e-6, 0.05e-9);
  EXPECT_NEAR(of("surface/test_uncompressed.sur", Levelling::none)["Sq"].value, 0.1192e-6, 0.1e-9);  // it is 0.11915
  EXPECT_NEAR(of("surface/test_uncompressed.sur", Levelling::plane)["Sq"].value, 0.0557e-6, 0.05e-9);
}

// A sine: Sa = 2 A / pi, Sq = A / sqrt 2, Ssk = 0, Sku = 1.5, Sz = 2 A, Sdq = sqrt 2 pi A / L.
TEST(Areal, OfASineAndATiltedPlane) {
  HeightMap map{400, 60, 1e-6, 2e-6, {}};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 400; ++x) map.z_m.push_back(1e-6 * std::sin(2 * pi * (x + 0.5) / 100));
  const Roughness r = roughness(treated(map, {.levelling = Levelling::none}, "t").map);
  EXPECT_NEAR(r["Sa"].value, 2e-6 / pi, 2e-10);
  EXPECT_NEAR(r["Sq"].value, 1e-6 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(r["Sz"].value, 2e-6, 1e-9);
  EXPECT_NEAR(r["Ssk"].value, 0, 1e-9);
  EXPECT_NEAR(r["Sku"].value, 1.5, 1e-9);
  EXPECT_NEAR(r["Sdq"].value, std::sqrt(2) * pi * 1e-6 / 100e-6, 8e-5);
  HeightMap plane{50, 40, 1e-6, 2e-6, {}};
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x) plane.z_m.push_back(0.75e-6 * x - 0.4 * 2e-6 * y);
  plane.z_m[77] = std::nan("");
  const Treated flat = treated(plane, {.levelling = Levelling::plane}, "t");
  EXPECT_NEAR(flat.tilt_x, 0.75, 1e-9);
  EXPECT_NEAR(flat.tilt_y, 0.4, 1e-9);  // y up
  EXPECT_EQ(flat.missing, 1u);
  EXPECT_NEAR(roughness(flat.map)["Sq"].value, 0, 1e-15);
  const Roughness tilted = roughness(treated(plane, {.levelling = Levelling::none}, "t").map);
  EXPECT_NEAR(tilted["Sdr"].value, std::sqrt(1 + 0.75 * 0.75 + 0.16) - 1, 1e-9);
  HeightMap bowl = plane;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x)
      bowl.z_m[static_cast<std::size_t>(y * 50 + x)] += 1e-9 * x * x + 3e-9 * x * y - 2e-9 * y * y;
  EXPECT_NEAR(roughness(treated(bowl, {.levelling = Levelling::quadratic}, "t").map)["Sq"].value, 0, 1e-15);
  for (std::size_t i = 0; i < 1001; ++i) plane.z_m[i] = std::nan("");
  EXPECT_THROW(treated(plane, {}, "t"), Error);
}

// ISO 16610-61: half of a wave as long as the nesting index passes.
TEST(Areal, FiltersPassHalfOfAWaveAsLongAsTheirNestingIndex) {
  HeightMap map{600, 30, 1e-6, 1e-6, {}};
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 600; ++x) map.z_m.push_back(1e-6 * std::sin(2 * pi * (x + 0.5) / 40));
  const auto amplitude = [&](const Treatment& t) {
    const HeightMap out = treated(map, t, "t").map;
    double sum = 0;
    for (std::size_t x = 100; x < 500; ++x)
      sum += out.at(x, 15) * std::sin(2 * pi * (static_cast<double>(x) + 0.5) / 40);
    return sum / 200;
  };
  EXPECT_NEAR(amplitude({Levelling::none, 40e-6, 0}), 0.5e-6, 2e-9);
  EXPECT_NEAR(amplitude({Levelling::none, 0, 40e-6}), 0.5e-6, 2e-9);
  EXPECT_NEAR(amplitude({Levelling::none, 10e-6, 0}), 1e-6 * std::pow(0.5, 1.0 / 16), 3e-9);
  EXPECT_NEAR(amplitude({Levelling::none, 0, 160e-6}), 1e-6 * (1 - std::pow(0.5, 16)), 3e-9);
}

// 80 maps. Intervals of 1.96 sigma that cover with 95 % do so in 69 of them or more with probability 0.9989; so do
// those that cover with 90 % in 64 or more with 0.996. Expected: the field's own values.
TEST(Areal, IntervalsCover) {
  const double width = 3, sq = 2e-7;
  // correlation exp(-r^2 / (4 w^2)); <(dz/dx)^2> in the middle of a cell = (1 - c1)(1 + c1) sq^2 / step^2 by both axes
  const double c1 = std::exp(-1 / (4 * width * width));
  const double sdq = std::sqrt(2 * (1 - c1) * (1 + c1)) * sq / 1e-6;
  int sq_in = 0, sa_in = 0, sdq_in = 0, ssk_in = 0, sku_in = 0;
  for (std::uint64_t k = 0; k < 80; ++k) {
    const Roughness r = roughness(treated(gaussian_map(96, width, sq, k), {.levelling = Levelling::none}, "t").map);
    const auto in = [&](const char* name, double truth) {
      return std::abs(r[name].value - truth) < 1.96 * *r[name].sigma;
    };
    sq_in += in("Sq", sq), sa_in += in("Sa", sq * std::sqrt(2 / pi)), sdq_in += in("Sdq", sdq);
    ssk_in += in("Ssk", 0), sku_in += in("Sku", 3);
    // an area of 4 pi w^2 points each: <rho^2> integrates to 2 pi w^2 ... 4 pi w^2
    if (k == 0) {
      EXPECT_NEAR(std::log(r.independent_areas / (96 * 96 / (2 * pi * width * width))), 0, 0.8);
    }
    EXPECT_FALSE(k == 0 && r.long_waves);
  }
  EXPECT_GE(sq_in, 69);
  EXPECT_GE(sa_in, 69);
  EXPECT_GE(sdq_in, 69);
  EXPECT_GE(ssk_in, 64);
  EXPECT_GE(sku_in, 64);
}

// Slopes of a Gaussian field are Beckmann's, alpha = sqrt 2 times their root mean square along each axis.
TEST(Normals, OfAGaussianFieldAreBeckmannWithItsAzimuth) {
  const double width = 3, sq = 2e-7;
  int u_in = 0, v_in = 0, azimuth_in = 0;
  for (std::uint64_t k = 0; k < 40; ++k) {
    const Normals n = normals_of(gaussian_map(144, width, sq, k, 2));
    const double cx = std::exp(-1 / (16 * width * width)), cy = std::exp(-1 / (4 * width * width));
    const double along = std::sqrt(2 * (1 - cx) * (1 + cy)) * sq / 1e-6,
                 across = std::sqrt(2 * (1 - cy) * (1 + cx)) * sq / 1e-6;
    const SlopeFit& f = n.fits[0];
    ASSERT_EQ(f.distribution, "beckmann");
    u_in += std::abs(f.alpha_u - across) < 1.96 * f.sigma_alpha_u;
    v_in += std::abs(f.alpha_v - along) < 1.96 * f.sigma_alpha_v;
    azimuth_in += std::abs(std::remainder(f.azimuth_rad - pi / 2, pi)) < 1.96 * f.sigma_azimuth_rad;
    double all = n.beyond;
    for (const double s : n.share) all += s;
    EXPECT_NEAR(all, 1, 1e-9);
  }
  EXPECT_GE(u_in, 33);  // of 40 at 95 %: with probability 0.9993
  EXPECT_GE(v_in, 33);
  EXPECT_GE(azimuth_in, 33);
}

// Independent GGX slopes as a map: every cell of two by two points is a facet of its own.
TEST(Normals, OfGgxFacetsAreRecognised) {
  Random random(3);
  HeightMap map{401, 401, 1e-6, 1e-6, std::vector<double>(401 * 401, std::nan(""))};
  for (std::size_t y = 0; y + 1 < 401; y += 3)
    for (std::size_t x = 0; x + 1 < 401; x += 3) {
      const double u = random.uniform(), r = std::sqrt(u / (1 - u)), phi = 2 * pi * random.uniform();
      const double a = 0.3 * r * std::cos(phi), b = 0.15 * r * std::sin(phi), c = std::cos(0.5), s = std::sin(0.5);
      const double sx = c * a - s * b, sy = s * a + c * b;
      for (const std::size_t i : {0u, 1u})
        for (const std::size_t j : {0u, 1u})
          map.z_m[(y + j) * 401 + x + i] = 1e-6 * (sx * static_cast<double>(i) - sy * static_cast<double>(j));
    }
  const Normals n = normals_of(map);
  EXPECT_EQ(n.slopes, 134u * 134u);
  const SlopeFit& f = n.fits[0];
  EXPECT_EQ(f.distribution, "ggx");
  EXPECT_NEAR(f.alpha_u, 0.3, 4 * f.sigma_alpha_u);
  EXPECT_NEAR(f.alpha_v, 0.15, 4 * f.sigma_alpha_v);
  EXPECT_NEAR(f.azimuth_rad, 0.5, 4 * f.sigma_azimuth_rad);
  EXPECT_LT(f.sigma_alpha_u, 0.01);
  EXPECT_LT(f.sigma_azimuth_rad, 0.03);
  EXPECT_NEAR(f.density(0, 0), 1 / (pi * f.alpha_u * f.alpha_v), 1e-12);
}

}  // namespace
}  // namespace gonio::relief
