// Polarizers as they are made, against formulas that are derived here from fields, not from Mueller matrices.
#include "photograph/polarizer_array.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "photograph/mechanisms/retarder_dispersion.h"
#include "photograph/polarizers.h"

namespace gonio::photograph {
namespace {

using Stokes = std::array<double, 4>;
constexpr std::array<std::array<int, 2>, 4> places = {{{1, 1}, {1, 0}, {0, 0}, {0, 1}}};  // 0, 45, 90, 135 degrees

double reading(const PolarizerArray& array, std::array<int, 2> at, const Stokes& s, Vec2 radius = {}) {
  const std::array<double, 4> row = analyser(array, at[0], at[1], radius);
  return row[0] * s[0] + row[1] * s[1] + row[2] * s[2] + row[3] * s[3];
}

// Stokes components of four readings by the ideal camera's formulas.
std::array<double, 3> seen(const PolarizerArray& array, const Stokes& s, Vec2 radius = {}) {
  std::array<double, 4> i{};
  for (std::size_t k = 0; k < 4; ++k) i[k] = reading(array, places[k], s, radius);
  return {(i[0] + i[1] + i[2] + i[3]) / 2, i[0] - i[2], i[1] - i[3]};
}

TEST(PolarizerArray, IsIdealUnlessSaid) {
  for (const auto& [x, y] : places) {
    const std::array<double, 4> row = analyser({}, x, y, {0.5, 0.3});
    EXPECT_EQ(row[0], behind_polarizer(1, 0, 0, polarizer_angle(x, y)));
    EXPECT_EQ(row[1], behind_polarizer(0, 1, 0, polarizer_angle(x, y)));
    EXPECT_EQ(row[2], behind_polarizer(0, 0, 1, polarizer_angle(x, y)));
    EXPECT_EQ(row[3], 0);
  }
}

// An extinction ratio e = I_max / I_min of fully polarized light shrinks every degree to (e - 1) / (e + 1).
TEST(PolarizerArray, LeakShrinksTheDegreeOfPolarization) {
  for (const double extinction : {20.0, 300.0}) {
    const PolarizerArray leaky{.leak = 1 / extinction};
    const Stokes full{2, 2, 0, 0};
    EXPECT_NEAR(reading(leaky, places[0], full) / reading(leaky, places[2], full), extinction, 1e-9);
    const Stokes part{1, 0.3, -0.4, 0.2};
    const auto [s0, s1, s2] = seen(leaky, part);
    const double shrunk = (extinction - 1) / (extinction + 1);
    EXPECT_NEAR(s1 / s0, 0.3 * shrunk, 1e-12);
    EXPECT_NEAR(s2 / s0, -0.4 * shrunk, 1e-12);
  }
}

// Malus: light along b behind an axis at a.
TEST(PolarizerArray, TurnsFollowMalus) {
  const double b = 0.4;
  const Stokes light{1, std::cos(2 * b), std::sin(2 * b), 0};
  PolarizerArray turned{.turn_rad = 0.1, .turn_45_rad = 0.02, .turn_90_rad = -0.03, .turn_135_rad = 0.04};
  const double own[] = {0, 0.02, -0.03, 0.04};
  for (std::size_t k = 0; k < 4; ++k) {
    const double axis = static_cast<double>(k) * pi / 4 + 0.1 + own[k];
    EXPECT_NEAR(reading(turned, places[k], light), std::pow(std::cos(axis - b), 2), 1e-12);
  }
}

// Jones: E along the radius times exp(i late), then an ideal polarizer, waves exp(-i w t). The picture's y is down,
// that of the fields up.
TEST(PolarizerArray, LensDelaysLightAlongTheRadius) {
  using Complex = std::complex<double>;
  const double late = 0.9;
  for (const Vec2 radius : {Vec2{0.6, 0}, Vec2{0, 0.8}, Vec2{0.5, -0.7}, Vec2{-0.3, 0.4}}) {
    const double square = radius.x * radius.x + radius.y * radius.y, length = std::sqrt(square);
    const double c = radius.x / length, s = -radius.y / length;
    const Complex ex{0.7, 0.1}, ey{-0.2, 0.6};
    const Complex out = (c * ex + s * ey) * std::polar(1.0, late * square), beside = c * ey - s * ex;
    const Complex x = c * out - s * beside, y = s * out + c * beside;
    const Complex both = ex * std::conj(ey);
    const Stokes light{std::norm(ex) + std::norm(ey), std::norm(ex) - std::norm(ey), 2 * both.real(), 2 * both.imag()};
    for (std::size_t k = 0; k < 4; ++k) {
      const double axis = static_cast<double>(k) * pi / 4;
      EXPECT_NEAR(reading({.retardance_rad = late}, places[k], light, radius),
                  std::norm(std::cos(axis) * x + std::sin(axis) * y), 1e-12);
    }
  }
}

// Circular light behind a quarter of a wave is linear: E_x i behind E_y turns s3 = 1 into s2 = -1.
TEST(PolarizerArray, AQuarterWaveMakesCircularLightLinear) {
  const auto [s0, s1, s2] = seen({.retardance_rad = pi / 2}, {1, 0, 0, 1}, {1, 0});
  EXPECT_NEAR(s0, 1, 1e-12);
  EXPECT_NEAR(s1, 0, 1e-12);
  EXPECT_NEAR(s2, -1, 1e-12);
  const auto axis = seen({.retardance_rad = pi / 2}, {1, 0.5, 0, 0}, {1, 0});  // along the radius: nothing happens
  EXPECT_NEAR(axis[1], 0.5, 1e-12);
}

TEST(RetarderDispersion, IsAPathOfOneOrder) {
  EXPECT_EQ(equation::retarder_dispersion(1.5, 0, 1.3), 1.5);
  EXPECT_NEAR(equation::retarder_dispersion(pi / 2, 1, 550.0 / 450), pi / 2 * 550 / 450, 1e-12);
}

}  // namespace
}  // namespace gonio::photograph
