// What balls of other metals show: radiances through Fresnel's equations in complex numbers, written out here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

using Index = std::complex<double>;
const Index chromium{3.18, 3.31}, silver{0.055, 3.32}, aluminium{0.96, 6.69}, steel{2.9, 3.0};

double reflected(Index metal, double theta) {
  const Index inside = std::sqrt(metal * metal - std::pow(std::sin(theta), 2));
  const double c = std::cos(theta);
  const Index s = (c - inside) / (c + inside), p = (metal * metal * c - inside) / (metal * metal * c + inside);
  return (std::norm(s) + std::norm(p)) / 2;
}

// 14 directions in 8 views, up to 83 degrees of incidence; `quadratic`: of the reading.
World ball_world(std::uint64_t seed, Index stated, Index truth, double noise = 0.004, double quadratic = 0) {
  World w;
  w.columns = {{"view", ""},     {"direction", ""}, {"theta_i", "rad"},  {"metal_n", "1"},
               {"metal_k", "1"}, {"value", "1"},    {"value_sigma", "1"}};
  w.rest = R"("model": "probe-radiance", "observed": ["value"], "sigma": ["value_sigma"], "group": "view")";
  Random random(seed, 41);
  for (int view = 0; view < 8; ++view)
    for (int d = 0; d < 14; ++d) {
      const double theta = 1.45 * random.uniform(), light = 0.2 + std::pow(1.35, d) / 10;
      const double read = light * reflected(truth, theta), value = read * (1 + quadratic * read);
      w.rows.push_back({view + 1.0, d + 1.0, theta, stated.real(), stated.imag(), value * (1 + noise * random.normal()),
                        noise * value});
    }
  return w;
}

struct Rates {
  int right = 0, nothing = 0, wrong = 0;
};
Rates rates(const char* what, Index stated, Index truth, int seeds, double noise = 0.004) {
  Rates r;
  for (int seed = 1; seed <= seeds; ++seed) {
    const TablesProblem problem = ball_world(static_cast<std::uint64_t>(seed), stated, truth, noise).problem();
    const std::string text = named(problem, explain(problem, {}));
    ++(text.empty() ? r.nothing : text == "probe.reflectance" ? r.right : r.wrong);
  }
  std::printf("%s: right %d, nothing %d, wrong %d of %d\n", what, r.right, r.nothing, r.wrong, seeds);
  return r;
}

TEST(ProbeRadiance, NothingIsNamedOfTheMetalThatItIs) {
  EXPECT_GE(rates("null", chromium, chromium, 20).nothing, 19);
}

TEST(ProbeRadiance, AnotherMetalIsNamed) {
  EXPECT_GE(rates("chromium said to be silver", silver, chromium, 8).right, 7);
  EXPECT_GE(rates("silver said to be chromium", chromium, silver, 8).right, 7);
  EXPECT_GE(rates("aluminium said to be chromium", chromium, aluminium, 8).right, 7);
}

// Both reflect nearly all light at every angle; aluminium's dip before grazing is 4 %, and all of the difference.
TEST(ProbeRadiance, SilverForAluminiumIsNotMistakenForSomethingElse) {
  EXPECT_LE(rates("aluminium said to be silver", silver, aluminium, 8).wrong, 1);
}

TEST(ProbeRadiance, TheFittedReflectanceIsThatOfTheTrueMetal) {
  const World world = ball_world(3, silver, chromium);
  const TablesProblem problem = world.problem();
  const Explanation e = explain(problem, {});
  ASSERT_EQ(named(problem, e), "probe.reflectance") << e.sentence;
  // Radiances are free: reflectances are known but for a factor, which the neighbourhood of normal incidence sets.
  std::vector<double> values = e.values;
  std::size_t normal = 0;
  while (problem.parameters()[normal].name != "probe.reflectance.normal") ++normal;
  const double dip = values[normal + 1];
  const auto fitted = [&](double theta) {
    const double c = std::cos(theta), m = 1 - c;
    return reflected(silver, theta) + values[normal] * (1 - std::pow(m, 5)) -
           dip * c * std::pow(m, 6) / (std::pow(6.0 / 7, 6) / 7);
  };
  for (double theta = 0; theta < 1.4; theta += 0.2)
    EXPECT_NEAR(fitted(theta) / fitted(0), reflected(chromium, theta) / reflected(chromium, 0), 0.02) << theta;
  EXPECT_EQ(named(problem, asked_again(world, problem, e)), "");
}

// It bends bright directions more, at whatever incidence: what radiances that are free leave of it is below a
// hundredth.
TEST(ProbeRadiance, ACurvedResponseIsNotTakenForAMetal) {
  int metal = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const TablesProblem problem = ball_world(seed, chromium, chromium, 0.004, -0.08).problem();
    const Explanation e = explain(problem, {});
    EXPECT_TRUE(e.significant);
    metal += named(problem, e).find("probe") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(metal, 0);
}

TEST(ProbeRadiance, WhatIsWrongWithATableIsSaid) {
  for (const auto& [column, value, words] : std::vector<std::tuple<std::size_t, double, std::string>>{
           {2, 1.6, "between 0 and 90 degrees"}, {3, -1, "metal_n -1"}, {4, -2, "metal_k -2"}}) {
    World w = ball_world(1, chromium, chromium);
    w.rows[0][column] = value;
    try {
      w.problem();
      ADD_FAILURE() << words;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      EXPECT_THAT(e.what(), testing::HasSubstr(words));
    }
  }
}

}  // namespace
}  // namespace gonio::explain::tables::tests
