// Laws of variation: against their formulas by hand, and what holds of every registered one.
#include "surface/law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace gonio::surface {
namespace {

double value(const std::string& id, std::vector<double> amounts, const LocalGeometry& here) {
  return find_law(id)->value(amounts, here);
}

Vec3 draw_unit(Random& random) {
  return normalized(Vec3{random.normal(), random.normal(), random.normal()});
}

TEST(PrintNormal, FollowsItsFormula) {
  const double h = std::sqrt(0.5);
  // 45 degrees: |sin 2t| = 1; 30 degrees from z: sin 60 = sqrt(3) / 2, to the power of 2: 3 / 4.
  EXPECT_NEAR(value("print-normal", {0.1, 2, 0, 0}, {{}, {h, 0, h}}), 0.1 + 0.9 / 2, 1e-12);
  EXPECT_NEAR(value("print-normal", {0.1, 2, 0, 0}, {{}, {0, -0.5, std::sqrt(0.75)}}), 0.1 + 0.9 * 0.75 / 2, 1e-12);
  EXPECT_NEAR(value("print-normal", {0.1, 2, 0, 0}, {{}, {0, 0.5, -std::sqrt(0.75)}}), 0.1 + 0.9 * 0.75 / 2, 1e-12);
  EXPECT_NEAR(value("print-normal", {0.1, 2, 0, 0}, {{}, {0, 0, 1}}), 0.1, 1e-12);
  EXPECT_NEAR(value("print-normal", {0.1, 2, 0, 0}, {{}, {1, 0, 0}}), 0.1, 1e-12);
  EXPECT_EQ(value("print-normal", {0.1, 0.5, 0, 0}, {{}, {h, 0, h}}), 1);  // 0.1 + 0.9 / 0.5, kept at 1
  EXPECT_NEAR(value("print-normal", {0.1, 2, pi / 2, 0}, {{}, {h, h, 0}}), 0.1 + 0.9 / 2, 1e-12);  // printed along x
}

TEST(PolishCurvature, FollowsItsFormula) {
  const auto at = [](double curvature) { return LocalGeometry{{}, {0, 0, 1}, curvature}; };
  EXPECT_NEAR(value("polish-curvature", {0.2, 5, 40}, at(40)), 0.2 + 0.8 / 2, 1e-12);
  EXPECT_NEAR(value("polish-curvature", {0.2, 5, 40}, at(-40)), 0.2 + 0.8 / 2, 1e-12);
  EXPECT_NEAR(value("polish-curvature", {0.2, 5, 40}, at(0)), 0.2 + 0.8 / (1 + std::exp(5.0)), 1e-12);
  EXPECT_NEAR(value("polish-curvature", {0.2, 5, 40}, at(1e9)), 1, 1e-12);
  // As published: 30 |H.n| with H over the mesh's longest one.
  const double longest = 700, here = 31;
  EXPECT_NEAR(value("polish-curvature", {0.1, 3, longest / 30}, at(here)),
              0.1 + 0.9 / (1 + std::exp(3 * (1 - 30 * here / longest))), 1e-12);
}

TEST(PrintLayers, Alternate) {
  const auto at = [](double z) { return LocalGeometry{{0.3, 0.2, z}, {1, 0, 0}}; };
  const std::vector<double> sharp = {0.1, 0.5, 0.002, 0, 0, 0, 0};
  EXPECT_EQ(value("print-layers", sharp, at(0.001)), 0.1);
  EXPECT_EQ(value("print-layers", sharp, at(0.003)), 0.5);
  EXPECT_EQ(value("print-layers", sharp, at(0.0041)), 0.1);
  EXPECT_EQ(value("print-layers", sharp, at(-0.001)), 0.5);
  EXPECT_EQ(value("print-layers", {0.1, 0.5, 0.002, 0.002, 0, 0, 0}, at(0.003)), 0.1);  // layer 0 begins at 2 mm
  const std::vector<double> smooth = {0.1, 0.5, 0.002, 0, 0.001, 0, 0};
  EXPECT_NEAR(value("print-layers", smooth, at(0.002)), 0.3, 1e-12);
  EXPECT_NEAR(value("print-layers", smooth, at(0.00225)), 0.1 + 0.4 * 0.84375, 1e-12);  // t = 3/4: 3 t^2 - 2 t^3
  EXPECT_NEAR(value("print-layers", smooth, at(0.0026)), 0.5, 1e-12);
}

std::vector<double> draw_amounts(const Law& law, Random& random) {
  std::vector<double> amounts;
  for (const auto& p : law.info().parameters) {
    const double u = random.uniform();
    amounts.push_back(p.upper / std::max(p.lower, 1e-300) > 1e4 && p.lower > 0
                          ? p.lower * std::pow(p.upper / p.lower, u)
                          : p.lower + (p.upper - p.lower) * u);
  }
  return amounts;
}

TEST(EveryLaw, StaysBetweenZeroAndOne) {
  ASSERT_FALSE(all_laws().empty());
  Random random(8);
  for (const Law* law : all_laws()) {
    EXPECT_EQ(find_law(law->info().id), law);
    EXPECT_EQ(law->info().family, manifest::Family::law);
    for (int i = 0; i < 20000; ++i) {
      const auto amounts = draw_amounts(*law, random);
      const Vec3 n = i % 3 == 0 ? Vec3{0, 0, i % 2 == 0 ? 1.0 : -1.0} : draw_unit(random);
      const LocalGeometry here{draw_unit(random) * random.uniform(), n, 1e3 * random.normal()};
      const double v = law->value(amounts, here);
      ASSERT_TRUE(v >= 0 && v <= 1) << law->info().id << " " << v;
    }
  }
}

// Where a law says that it is continuous, a step of 1e-9 of the geometry changes it by less than `steepness` times
// that.
TEST(SmoothLaws, AreContinuous) {
  Random random(9);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 n = draw_unit(random), near = normalized(n + draw_unit(random) * 1e-9);
    const std::vector<double> normal = {0.1, 1 + 9 * random.uniform(), random.uniform(), random.uniform()};
    EXPECT_NEAR(value("print-normal", normal, {{}, n}), value("print-normal", normal, {{}, near}), 1e-8);
    const double c = 1000 * random.normal();
    const std::vector<double> polish = {0.1, 10 * random.uniform(), 100};
    EXPECT_NEAR(value("polish-curvature", polish, {{}, n, c}), value("polish-curvature", polish, {{}, n, c + 1e-6}),
                1e-6);
    const std::vector<double> layers = {0.1, 0.9, 0.001, 0.0003, 0.0002 + 0.001 * random.uniform(), 0.3, 0.7};
    const Vec3 p = draw_unit(random) * 0.01;
    EXPECT_NEAR(value("print-layers", layers, {p, n}), value("print-layers", layers, {p + n * 1e-12, n}), 1e-7);
  }
}

}  // namespace
}  // namespace gonio::surface
