#include "relief/microstructure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "base/random.h"
#include "manifest/document.h"
#include "manifest/sections/print.h"
#include "relief/microstructure_use.h"
#include "relief/sparse_convolution.h"

namespace gonio::relief {
namespace {

constexpr double um = 1e-6;
const auto no_further = [](const std::string&, const std::string&) { return false; };

ShareAt made(const std::string& text, double depth_m = 18 * um) {
  return structure_of({}, parse_microstructure(text, "--structure", no_further), depth_m, "s");
}
double at(const ShareAt& s, double u, double v) {
  return s({{u, v}, {u, v, 0}});
}

// Whoever is in the family: a share at every place, by presets or by its first numbers.
TEST(Microstructure, EveryMemberStaysBetweenNothingAndAll) {
  std::set<std::string> ids;
  for (const Microstructure* m : all_microstructures()) {
    EXPECT_EQ(m->info().family, manifest::Family::microstructure);
    EXPECT_TRUE(ids.insert(m->info().id).second);
    std::vector<double> amounts;
    for (const auto& p : m->info().parameters)
      amounts.push_back(p.preset ? *p.preset : p.name == "ridge_rad" ? 0.1 : 100 * um);
    io::GreyImage picture{2, 2, {0, 255, 128, 60}, {}};
    MicrostructureFiles files{m->info().id == "picture" ? &picture : nullptr,
                              m->info().takes_expression ? "2*sin(u_m*1e5)+x_m" : ""};
    const ShareAt share = m->made(amounts, 18 * um, files, "s");
    for (int k = 0; k < 500; ++k) {
      const double value = share({{k * 1.7 * um, -k * 3.1 * um}, {k * 0.3 * um, 5 * um, k * 2 * um}});
      EXPECT_GE(value, 0) << m->info().id;
      EXPECT_LE(value, 1) << m->info().id;
    }
  }
}

// Luongo et al. 2020, equation 3.
TEST(Microstructure, SinusoidIsThePublishedOne) {
  const ShareAt s = made("sinusoid:wave_u_m=50um,wave_v_m=200um");
  for (const auto& [u, v] : {std::pair{3.0, 17.0}, {-20.0, 81.0}})
    EXPECT_NEAR(at(s, u * um, v * um), 0.5 * std::sin(2 * pi * u / 50) * std::sin(2 * pi * v / 200) + 0.5, 1e-12);
  EXPECT_NEAR(at(made("sinusoid:wave_u_m=50um,share=0.2"), 12.5 * um, 9), 1, 1e-12);
  EXPECT_NEAR(at(made("sinusoid:wave_u_m=50um,share=0.2"), 37.5 * um, 9), 0.8, 1e-12);
}

// Facets of 10 degrees: over the layer's depth the share falls with tan 10, towards +v.
TEST(Microstructure, RidgesHaveTheirSlope) {
  const ShareAt s = made("ridges:ridge_rad=10deg,pitch_m=100um");
  EXPECT_NEAR((at(s, 0, 60 * um) - at(s, 5, 20 * um)) * 18 / 40, -std::tan(10 * pi / 180), 1e-9);
  const ShareAt turned = made("ridges:ridge_rad=10deg,pitch_m=100um,turn_rad=90deg");
  EXPECT_NEAR(at(turned, -20 * um, 3), at(s, 0, 20 * um), 1e-9);
  EXPECT_THROW(made("ridges:ridge_rad=10deg,pitch_m=120um"), Error);  // 20.5 um high
}

TEST(Microstructure, NoiseIsTheAppendixs) {
  const ShareAt s = made("noise:amplitude=2,frequency=16");
  const Vec3 p{0.31e-3, -0.2e-3, 1.1e-3};
  EXPECT_DOUBLE_EQ(s({{9, 9}, p}), published_noise_grey(p * 16000.0, 2));
}

// Drawn out over eight cells along u it stays alike along u and changes along v as before, wherever u points to; the
// mean of eight is flatter by about the root of eight. 1500 places, correlations to 0.1 (4 sigma).
TEST(Microstructure, StretchedNoiseFollowsU) {
  const ShareAt s = made("noise:amplitude=1,frequency=16,stretch_m=500um"),
                plain = made("noise:amplitude=1,frequency=16");
  const ShareAt turned = made("noise:amplitude=1,frequency=16,stretch_m=500um,turn_rad=90deg");
  const Vec3 u = normalized(Vec3{1, 2, -2}), v = normalized(cross(u, Vec3{0, 0, 1}));
  double here2 = 0, along = 0, across = 0, turned_along = 0, turned2 = 0, plain2 = 0;
  Random random(5, 1);
  for (int k = 0; k < 1500; ++k) {
    const Vec3 p{5e-3 * random.uniform(), 5e-3 * random.uniform(), 5e-3 * random.uniform()};
    const auto of = [&](const ShareAt& share, Vec3 at) { return share({{9, 9}, at, u, v}) - 0.5; };
    const double here = of(s, p), t = of(turned, p), one = of(plain, p);
    here2 += here * here, turned2 += t * t, plain2 += one * one;
    along += here * of(s, p + u * 62.5e-6), across += here * of(s, p + v * 62.5e-6);
    turned_along += t * of(turned, p + v * 62.5e-6);
  }
  EXPECT_GT(along / here2, 0.8);  // 7 of 8 cells in common
  EXPECT_LT(std::abs(across / here2), 0.1);
  EXPECT_GT(turned_along / turned2, 0.8);
  EXPECT_NEAR(std::sqrt(here2 / plain2), 1 / std::sqrt(8.0), 0.12);
  EXPECT_THROW(made("noise:stretch_m=1m"), Error);
}

TEST(Microstructure, ExpressionsAreEvaluatedAndRefused) {
  EXPECT_NEAR(at(made("expression:0.5+0.5*sin(2*pi*u_m/1e-4)"), 25 * um, 0), 1, 1e-12);
  EXPECT_NEAR(at(made("expression:7*v_m"), 0, 3), 1, 1e-12);
  EXPECT_THROW(made("expression:0.5+q"), Error);
  EXPECT_THROW(made("expression:0.5+"), Error);
  EXPECT_THROW(made("expression:"), Error);
  EXPECT_THROW(at(made("expression:sqrt(0-1-u_m)"), 0, 0), Error);
}

TEST(Microstructure, WordsOutOfPlaceAreRefused) {
  for (const char* text : {"noises", "noise:amplitude=x", "noise:a=3", "noise:amplitude", "ridges:pitch_m=1s",
                           "sinusoid:wave_u_m=50um,depth=2"})
    EXPECT_THROW(parse_microstructure(text, "--structure", no_further), Error) << text;
  EXPECT_THROW(made("ridges:pitch_m=100um"), Error);  // no tilt
  EXPECT_THROW(made("picture:pixel_m=10um"), Error);  // no picture
}

}  // namespace
}  // namespace gonio::relief
