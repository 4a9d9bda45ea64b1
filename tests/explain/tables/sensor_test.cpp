// Tables of grey levels: what was put in is found with an interval that covers it, what was not is not named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "manifest/sections/mechanism_use.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

double ideal(double f, double, double) {
  return f;
}

TEST(SensorTable, AnIdealSensorHasNothingToExplain) {
  int named_something = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const TablesProblem problem = sensor_world(seed, ideal).problem();
    named_something += !explain(problem, {}).named.empty();
  }
  EXPECT_EQ(named_something, 0);
}

struct Case {
  std::string id, parameter;
  double value;
  std::function<double(double, double, double)> reading;
};

class Injected : public testing::TestWithParam<int> {
 public:
  static std::vector<Case> cases() {
    return {{"sensor.black-offset", "sensor.black-offset.offset", 12, [](double f, double, double) { return f + 12; }},
            {"sensor.shutter", "sensor.shutter.extra_s", 2e-4,
             [](double f, double e, double) { return f * (e + 2e-4) / e; }},
            {"light.drift", "light.drift.amplitude", 0.12,
             [](double f, double, double t) { return f * (1 + 0.12 * std::exp(-t / 150)); }},
            {"sensor.saturation", "sensor.saturation.full_scale", 400,
             [](double f, double, double) { return std::min(f, 400.0); }}};
  }
};

TEST_P(Injected, IsNamedWithAnIntervalThatCoversIt) {
  const Case c = cases()[static_cast<std::size_t>(GetParam())];
  const TablesProblem problem = sensor_world(11, c.reading).problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), c.id) << e.sentence;
  const Estimate* found = estimate_of(problem, e, c.parameter);
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->value, c.value, 4 * found->sigma);
  EXPECT_NEAR(found->value, c.value, 0.25 * c.value);
}
INSTANTIATE_TEST_SUITE_P(Terms, Injected, testing::Range(0, 4));

double dark(double f, double exposure, double) {
  return f + 2000 * exposure;
}

// What grows with the exposure is light like any other to patches of unknown radiance. Of known ones it is told from an
// offset, and not from light of the room: that takes a lens cap.
TEST(SensorTable, DarkCurrentIsLightUntilRadiancesAreKnown) {
  const TablesProblem unknown = sensor_world(11, dark).problem();
  const Explanation silent = explain(unknown, {});
  EXPECT_EQ(named(unknown, silent), "");
  for (const Isolability& i : silent.isolability)
    if (unknown.candidates()[i.candidate].id() == "sensor.dark-current") {
      EXPECT_FALSE(i.visible) << i.surviving_share;
    }
  for (std::uint64_t seed = 11; seed < 15; ++seed) {
    World w = sensor_world(seed, dark);
    w.columns[0] = {"radiance", ""};
    for (std::vector<double>& row : w.rows) row[0] = 1e3 * std::pow(1.9, row[0]);
    const TablesProblem problem = w.problem();
    const Explanation e = explain(problem, {});
    ASSERT_EQ(e.not_told_apart.size(), 1u) << e.sentence;
    std::set<std::string> listed;
    for (const std::size_t c : e.not_told_apart[0]) listed.insert(problem.candidates()[c].id());
    EXPECT_EQ(listed, (std::set<std::string>{"light.ambient", "sensor.dark-current"})) << e.sentence;
    Options asked;
    asked.hypotheses = {"sensor.dark-current", "sensor.black-offset"};  // under a cap there is no light of the room
    const Explanation capped = explain(problem, asked);
    EXPECT_EQ(named(problem, capped), "sensor.dark-current") << capped.sentence;
    const Estimate* found = estimate_of(problem, capped, "sensor.dark-current.rate_per_s");
    ASSERT_NE(found, nullptr);
    EXPECT_NEAR(found->value, 2000, 4 * found->sigma);
    EXPECT_NEAR(found->value, 2000, 200);
  }
}

TEST(SensorTable, NonLinearityIsNamedAndStatedAtTheLargestReading) {
  const World w = sensor_world(5, [](double f, double, double) { return f * (1 - 0.1 * f / 1300); });
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "sensor.non-linearity") << e.sentence;
  manifest::Document document = w.document();
  problem.apply(e, document);
  const manifest::MechanismUse& use = document.mechanisms.at("sensor.non-linearity");
  EXPECT_NEAR(use.parameters.at("quadratic").scalar() / use.parameters.at("reference").scalar(), -0.1 / 1300, 2e-5);
  // The upgraded manifest explains itself: nothing is left.
  const TablesProblem again(document, "t", {}, false);
  EXPECT_EQ(named(again, explain(again, {})), "");
}

// Readings of one patch at one exposure cannot tell an offset from room light; another exposure can, and is proposed.
TEST(SensorTable, AnotherExposureIsProposedAndItsRowsArePredicted) {
  const TablesProblem problem = sensor_world(2, ideal).problem();
  const std::vector<Proposal> proposals = problem.proposals();
  ASSERT_EQ(proposals.size(), 2u);  // a quarter of the shortest, four times the longest
  EXPECT_NEAR(proposals[0].setup.find("exposure_s")->as_number(), 0.0005, 1e-9);
  std::vector<double> values = preliminary_fit(problem);
  const ProposedRows base = problem.propose(values, 0);
  ASSERT_EQ(base.prediction.size(), 4u);
  EXPECT_GT(base.sigma[0], 0);
  for (std::size_t p = 0; p < values.size(); ++p)
    if (problem.parameters()[p].name == "sensor.black-offset.offset") values[p] = 7;
  EXPECT_NEAR(problem.propose(values, 0).prediction[0] - base.prediction[0], 7, 1e-9);
}

TEST(SensorTable, APowerLawIsNotTakenForAQuadratic) {
  const World w = sensor_world(6, [](double f, double, double) { return 1400 * std::pow(f / 1400, 0.85); });
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "sensor.non-linearity") << e.sentence;
  const Estimate* gamma = estimate_of(problem, e, "sensor.non-linearity.gamma");
  ASSERT_NE(gamma, nullptr) << e.sentence;
  EXPECT_NEAR(gamma->value, 0.85, 4 * gamma->sigma);
  manifest::Document document = w.document();
  problem.apply(e, document);
  EXPECT_FALSE(document.mechanisms.at("sensor.non-linearity").parameters.contains("quadratic"));
  const TablesProblem again(document, "t", {}, false);
  EXPECT_EQ(named(again, explain(again, {})), "");
}

TEST(SensorTable, NeutralTermsLeaveThePredictionBitForBit) {
  const TablesProblem problem = sensor_world(1, ideal).problem();
  const std::vector<double> values = preliminary_fit(problem);
  ASSERT_FALSE(problem.candidates().empty());
  for (std::size_t g = 0; g < problem.observations().groups(); ++g) {
    const std::size_t rows = problem.observations().first[g + 1] - problem.observations().first[g];
    std::vector<double> with(rows), without(rows);
    problem.predict(values, g, with);
    problem.bound().predict(std::span(values).first(problem.bound().parameters().size()), problem.table().first[g],
                            problem.table().first[g + 1], without);
    for (std::size_t i = 0; i < rows; ++i) without[i] /= problem.reference(problem.observations().first[g] + i);
    EXPECT_EQ(with, without);
  }
}

// Forty nulls whose noise has to be found first, at a level of 1 %: more than two names has a probability of 0.8 %.
TEST(SensorTable, AnIdealSensorOfUnknownNoiseHasNothingToExplain) {
  int named_something = 0;
  for (std::uint64_t seed = 101; seed <= 140; ++seed)
    named_something += !explain(sensor_world(seed, ideal, false).problem(), {}).named.empty();
  EXPECT_LE(named_something, 2);
}

TEST(SensorTable, NoiseIsFoundFromNeighboursWithin30Percent) {
  const TablesProblem problem = sensor_world(3, ideal, false).problem();
  const Table& t = problem.table();
  double ratio = 0;
  for (std::size_t r = 0; r < t.rows(); ++r)
    ratio +=
        problem.observations().sigma[r] * problem.reference(r) / (*t.find("truth"))[r] / static_cast<double>(t.rows());
  EXPECT_NEAR(ratio, 1, 0.3);
}

}  // namespace
}  // namespace gonio::explain::tables::tests
