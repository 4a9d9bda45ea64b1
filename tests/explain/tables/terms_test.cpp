// Walks the registry of terms: each vanishes to the bit at its neutral values, changes something at others, and its
// mechanism's conditions are among the problem's where its columns are there. Then tables with one effect each.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

// Every column that any term reads; the values vary independently.
World all_columns(std::uint64_t seed, const std::function<double(const std::map<std::string, double>&)>& effect,
                  double noise = 0.002) {
  World w;
  w.columns = {{"exposure_s", "s"},   {"time_s", "s"},    {"distance_m", "m"}, {"path_m", "m"},
               {"image_radius", "1"}, {"theta_i", "rad"}, {"theta_o", "rad"},  {"row", "px"},
               {"channel", "1"},      {"series", "1"},    {"f", "1"},          {"f_sigma", "1"}};
  w.rest = R"("model": "expression", "expression": "a*exposure_s", "parameters": {"a": {"value": 1, "free": true}},
              "observed": ["f"], "sigma": ["f_sigma"], "group": "series")";
  Random random(seed, 5);
  for (int i = 0; i < 600; ++i) {
    std::map<std::string, double> x = {{"exposure_s", 0.01 * std::pow(10, random.uniform())},
                                       {"time_s", 1000.0 * i / 600},
                                       {"distance_m", random.uniform(0.5, 1.5)},
                                       {"path_m", random.uniform(0, 0.05)},
                                       {"image_radius", random.uniform(0, 1.2)},
                                       {"theta_i", random.uniform(0, 1.3)},
                                       {"theta_o", random.uniform(0, 1.3)},
                                       {"row", static_cast<double>(random.below(1000))},
                                       {"channel", static_cast<double>(i % 3)},
                                       {"series", static_cast<double>(i % 12)}};
    x["ideal"] = 7 * x["exposure_s"];
    const double f = effect(x), sigma = noise * f;
    std::vector<double> row;
    for (const auto& [column, unit] : w.columns)
      row.push_back(column == "f" ? f + sigma * random.normal() : column == "f_sigma" ? sigma : x[column]);
    w.rows.push_back(std::move(row));
  }
  return w;
}

TEST(Terms, EveryOneVanishesAtNeutralAndDeclaresWhatTheProblemFills) {
  const TablesProblem problem = all_columns(1, [](const auto& x) { return x.at("ideal"); }).problem();
  std::set<std::string> conditions;
  for (const Condition& c : problem.observations().conditions) conditions.insert(c.name);
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
  const std::size_t rows = problem.observations().first[1];
  std::vector<double> neutral(rows), moved(rows), plain(rows);
  problem.predict(values, 0, neutral);
  problem.bound().predict(std::span(values).first(problem.bound().parameters().size()), 0, problem.table().first[1],
                          plain);
  for (std::size_t i = 0; i < rows; ++i) plain[i] /= problem.reference(i);
  EXPECT_EQ(neutral, plain);
  std::size_t of_expressions = 0;
  for (const Term* term : all_forms()) {
    const mechanism::Mechanism& m = term->mechanism();
    of_expressions += term->models.empty() || std::ranges::find(term->models, "expression") != term->models.end();
    const auto candidate =
        std::ranges::find_if(problem.candidates(), [&](const Candidate& c) { return c.id() == m.id; });
    if (candidate == problem.candidates().end()) continue;
    std::vector<double> with = values;
    for (const std::size_t p : candidate->parameters) with[p] = problem.parameters()[p].start;
    if (m.id == "sensor.saturation") with[candidate->parameters[0]] *= 0.01;
    problem.predict(with, 0, moved);
    EXPECT_NE(moved, neutral) << m.id;
    for (const std::string& condition : m.conditions) {
      if (condition == "light.visibility" || condition == "scene.ambient-visibility") continue;  // nothing occludes
      EXPECT_TRUE(conditions.contains(condition)) << m.id << " is seen in " << condition;
    }
  }
  EXPECT_EQ(problem.candidates().size(), of_expressions);  // every column is there, so that all of them apply
}

struct Case {
  const char *id, *parameter;
  double value;
  double (*effect)(const std::map<std::string, double>& x);
};
const Case cases[] = {
    {"light.inverse-square", "light.inverse-square.nearness_per_m", 0.5,
     [](const std::map<std::string, double>& x) {
       return x.at("ideal") / std::pow(1 + 0.5 * (x.at("distance_m") - 0.5), 2);
     }},
    {"volume.absorption", "volume.absorption.sigma_a_per_m", 4,
     [](const std::map<std::string, double>& x) { return x.at("ideal") * std::exp(-4 * x.at("path_m")); }},
    {"optics.vignetting", "optics.vignetting.falloff", 0.1,
     [](const std::map<std::string, double>& x) {
       return x.at("ideal") * (1 - 0.1 * std::pow(x.at("image_radius"), 2));
     }},
    {"reference.tile", "reference.tile.incidence", -0.15,
     [](const std::map<std::string, double>& x) {
       const double i = 1 - std::cos(x.at("theta_i")), o = 1 - std::cos(x.at("theta_o"));
       return x.at("ideal") * (1 - 0.15 * i * i - 0.1 * o * o);
     }},
    {"light.spectrum", "light.spectrum.red_share", 0.05,
     [](const std::map<std::string, double>& x) {
       const double share = x.at("channel") == 0 ? 0.05 : x.at("channel") == 2 ? -0.04 : 0;
       return x.at("ideal") * (1 + share * x.at("time_s") / (1000.0 * 599 / 600));
     }},
    {"sensor.row-pattern", "sensor.row-pattern.amplitude", 0.04,
     [](const std::map<std::string, double>& x) {
       return x.at("ideal") * (1 + 0.04 * std::sin(2 * std::numbers::pi * x.at("row") / 230 + 0.4));
     }},
    {"light.drift", "light.drift.amplitude", -0.06,
     [](const std::map<std::string, double>& x) {
       return x.at("ideal") * (1 - 0.06 * std::exp(-x.at("time_s") / 300));
     }},
};

class OneEffect : public testing::TestWithParam<Case> {};

TEST_P(OneEffect, IsNamedAndItsIntervalCoversIt) {
  const Case& c = GetParam();
  const TablesProblem problem = all_columns(21, c.effect).problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), c.id) << e.sentence;
  const Estimate* found = estimate_of(problem, e, c.parameter);
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->value, c.value, 4 * found->sigma);
  EXPECT_NEAR(found->value, c.value, 0.15 * std::abs(c.value));
}
INSTANTIATE_TEST_SUITE_P(Terms, OneEffect, testing::ValuesIn(cases));

// Readings in proportion to the exposure: a constant is a shutter that stays open longer. Both are reported.
TEST(Terms, AnOffsetAndALateShutterAreOneWhereOnlyTheExposureVaries) {
  const TablesProblem problem = all_columns(21, [](const auto& x) { return x.at("ideal") + 0.01; }).problem();
  const Explanation e = explain(problem, {});
  std::set<std::string> ids;
  for (const std::size_t c : e.named) ids.insert(problem.candidates()[c].id());
  for (const std::vector<std::size_t>& other : e.not_told_apart)
    for (const std::size_t c : other) ids.insert(problem.candidates()[c].id());
  EXPECT_TRUE(ids.contains("sensor.black-offset")) << e.sentence;
  EXPECT_TRUE(ids.contains("sensor.shutter")) << e.sentence;
}

// A shutter may be late by most of the shortest exposure.
TEST(Terms, AShutterThatIsLateByMostOfTheShortestExposureIsNamed) {
  World w;
  w.columns = {{"exposure_s", "s"}, {"radiance", "1"}, {"series", "1"}, {"f", "1"}, {"f_sigma", "1"}};
  w.rest = R"("model": "expression", "expression": "a*radiance*exposure_s", "group": "series",
              "parameters": {"a": {"value": 1, "free": true}}, "observed": ["f"], "sigma": ["f_sigma"])";
  Random random(8, 2);
  for (int i = 0; i < 300; ++i) {
    const double exposure = 0.02 * std::pow(2, -static_cast<double>(random.below(6))), radiance = random.uniform(5, 50);
    const double f = 1.3 * radiance * (exposure + 4.7e-4), sigma = 0.005 * f;
    w.rows.push_back({exposure, radiance, static_cast<double>(i % 10), f + sigma * random.normal(), sigma});
  }
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "sensor.shutter") << e.sentence;
  const Estimate* extra = estimate_of(problem, e, "sensor.shutter.extra_s");
  ASSERT_NE(extra, nullptr);
  EXPECT_NEAR(extra->value, 4.7e-4, 4 * extra->sigma);
}

// Whatever acts on tables says so in its declaration.
TEST(Terms, MechanismsOfTermsAreDeclaredForTables) {
  for (const Term* term : all_forms()) {
    const mechanism::Mechanism& m = term->mechanism();
    EXPECT_TRUE(std::ranges::find(m.domains, "tables") != m.domains.end()) << m.id;
  }
}

// Sixteen nulls at a level of 1 %: more than one name has a probability of 1.1 %.
TEST(Terms, NothingIsNamedWhereNothingWasLeftOut) {
  int named_something = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const TablesProblem problem = all_columns(
                                      seed, [](const auto& x) { return x.at("ideal"); }, 0.01)
                                      .problem();
    named_something += !explain(problem, {}).named.empty();
  }
  EXPECT_LE(named_something, 1);
}

TEST(VolumeTable, IndexAndDispersionShowInTheAngleOfRefraction) {
  World w;
  w.columns = {{"theta_i", "rad"}, {"wavelength_m", "m"}, {"theta_t", "rad"}, {"s", "rad"}};
  w.rest =
      R"("model": "volume", "observed": ["theta_t"], "sigma": ["s"], "parameters": {"eta": 1.5}, "group": "theta_i")";
  Random random(4, 4);
  for (int i = 1; i <= 14; ++i)
    for (int k = 0; k < 12; ++k) {
      const double theta = 0.09 * i, lambda = 420e-9 + 22e-9 * k;
      const double eta = 1.5 + 8e-15 * (1 / (lambda * lambda) - 1 / (589.3e-9 * 589.3e-9));
      w.rows.push_back({theta, lambda, std::asin(std::sin(theta) / eta) + 2e-4 * random.normal(), 2e-4});
    }
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {.smallest_effect = 0.001});
  EXPECT_EQ(named(problem, e), "volume.dispersion") << e.sentence;
}

}  // namespace
}  // namespace gonio::explain::tables::tests
