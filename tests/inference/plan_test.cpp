// Plans on a problem where two effects are the same at the one setting that was recorded: p x^2 and q x^2 t at t = 1.
#include "inference/plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "base/text.h"
#include "explain/engine.h"
#include "inference/evidence.h"
#include "inference/wording.h"

namespace gonio::explain::tests {
namespace {

constexpr double noise = 0.1;

class TwinProblem : public Problem {
 public:
  explicit TwinProblem(std::uint64_t seed, double amplitude = 0.3) {
    Random random(seed, 3);
    parameters_ = {{.name = "bench/slope", .unit = "1", .prior_sigma = 0.2},
                   {.name = "twin.still.p", .unit = "mm", .start = 0.1, .lower = -2, .upper = 2, .size = 0.1},
                   {.name = "twin.timed.q", .unit = "mm", .start = 0.1, .lower = -2, .upper = 2, .size = 0.1}};
    base_ = {0};
    mechanisms_[0].id = "twin.still", mechanisms_[1].id = "twin.timed";
    for (mechanism::Mechanism& m : mechanisms_) m.stage = "bench", m.conditions = {"bench.x"};
    mechanisms_[0].mistaken_for = {{"twin.timed", "wait twice as long"}};
    candidates_ = {{&mechanisms_[0], {}, {1}, {}}, {&mechanisms_[1], {}, {2}, {}}};
    Condition x{"bench.x", "m", "bench", {}, {}};
    observations_.first.push_back(0);
    for (std::size_t g = 0; g < 8; ++g) {
      const std::string name = "group-" + std::to_string(g);
      observations_.group.push_back(name);
      base_.push_back(parameters_.size());
      parameters_.push_back({.name = name + "/offset", .unit = "mm", .groups = {g}});
      for (std::size_t i = 0; i < 30; ++i) {
        x.values.push_back(random.uniform(-1, 1));
        observations_.value.push_back(0.4 * x.values.back() + amplitude * x.values.back() * x.values.back() +
                                      noise * random.normal());
        observations_.sigma.push_back(noise);
        observations_.norm.push_back(1);
        observations_.block.push_back(static_cast<std::uint32_t>(g * 30 + i));
      }
      observations_.first.push_back(observations_.value.size());
    }
    observations_.conditions = {x};
  }
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    for (std::size_t i = 0; i < prediction.size(); ++i)
      prediction[i] =
          at(values, observations_.conditions[0].values[observations_.first[group] + i], 1) + values[3 + group];
  }
  std::vector<Proposal> proposals() const override {
    return {{"the same once more", manifest::Value::object({{"time_s", 1.0}})},
            {"wait twice as long", manifest::Value::object({{"time_s", 2.0}})},
            {"wait twice as long, at one place", manifest::Value::object({{"time_s", 2.0}, {"x_m", 0.5}})}};
  }
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override {
    ProposedRows rows;
    for (int i = 0; i < 21; ++i)
      rows.prediction.push_back(at(values, proposal == 2 ? 0.5 : -1 + 0.1 * i, proposal == 0 ? 1 : 2));
    rows.sigma.assign(21, noise);
    rows.nuisance = {std::vector<double>(21, 1.0)};  // its own offset
    return rows;
  }
  std::string domain() const override { return "bench"; }
  std::string unit() const override { return "mm"; }
  std::string score_name() const override { return "RMS"; }
  std::string group_noun() const override { return "group"; }
  Importance importance() const override { return Importance::share_of_residual; }
  void apply(const Explanation&, manifest::Document&) const override {}
  Illustration illustrate(const Explanation&, const std::filesystem::path&, manifest::Document&) const override {
    return {};
  }

 protected:
  static double at(std::span<const double> v, double x, double t) { return v[0] * x + (v[1] + v[2] * t) * x * x; }

 private:
  mechanism::Mechanism mechanisms_[2];
};

// Four waits, and a turn that tells less.
class ManyWays : public TwinProblem {
 public:
  using TwinProblem::TwinProblem;
  std::vector<Proposal> proposals() const override {
    std::vector<Proposal> all;
    for (const double t : waits) all.push_back({format("wait %.1f", t), manifest::Value::object({{"time_s", t}})});
    all.back() = {"turn", manifest::Value::object({{"turn_deg", 5.0}})};
    return all;
  }
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override {
    ProposedRows rows;
    for (int i = 0; i < 21; ++i) rows.prediction.push_back(at(values, -1 + 0.1 * i, waits[proposal]));
    rows.sigma.assign(21, noise);
    rows.nuisance = {std::vector<double>(21, 1.0)};
    return rows;
  }

 private:
  static constexpr double waits[] = {2.0, 1.9, 1.8, 1.7, 1.4};
};

TEST(Plan, HoldsTheBestOfEachKind) {
  const ManyWays problem(1);
  const Explanation e = explain(problem, {.draws = 499});
  std::vector<std::string> sentences;
  for (const PlannedMeasurement& p : e.plan) sentences.push_back(p.sentence);
  EXPECT_EQ(sentences, (std::vector<std::string>{"wait 2.0", "wait 1.9", "turn"}));
}

TEST(Plan, TheMeasurementThatPartsTwinsComesFirst) {
  const TwinProblem problem(1);
  const Explanation e = explain(problem, {.draws = 499});
  ASSERT_EQ(e.verdict, Verdict::ambiguous) << e.sentence;
  ASSERT_EQ(e.plan.size(), 1u);  // the others separate nothing: the same, or what an offset absorbs
  EXPECT_EQ(e.plan[0].sentence, "wait twice as long");
  EXPECT_EQ(e.plan[0].separates.size(), 2u);
  EXPECT_EQ(e.plan[0].setup, manifest::Value::object({{"time_s", 2.0}}));
  // d = p x^2 less its mean over the 21 places, in noise widths; what the amplitude's uncertainty leaves open is small.
  double mean = 0, sum = 0;
  for (int i = 0; i < 21; ++i) mean += std::pow(-1 + 0.1 * i, 2) / 21;
  for (int i = 0; i < 21; ++i) sum += std::pow(std::pow(-1 + 0.1 * i, 2) - mean, 2);
  const double bound = 0.3 * std::sqrt(sum) / noise;
  EXPECT_LT(e.plan[0].z, 1.15 * bound);
  EXPECT_GT(e.plan[0].z, 0.7 * bound);
  EXPECT_NE(e.next_measurement.find("wait twice as long"), std::string::npos) << e.next_measurement;
}

TEST(Plan, NothingIsPlannedWhereNothingIsOpen) {
  const TwinProblem problem(2, 0);
  const Explanation e = explain(problem, {.draws = 499});
  EXPECT_EQ(e.verdict, Verdict::null);
  EXPECT_TRUE(e.plan.empty());
}

TEST(Compensation, SaysWhetherParametersMovedTowardsTheirCalibration) {
  const TwinProblem problem(3);
  const Explanation e = explain(problem, {.draws = 499});
  ASSERT_EQ(e.compensation.size(), 1u);
  const Compensation& c = e.compensation[0];
  ASSERT_TRUE(c.calibrated.has_value());
  EXPECT_EQ(*c.calibrated, 0);
  EXPECT_EQ(*c.calibrated_sigma, 0.2);
  EXPECT_EQ(c.towards, std::abs(c.after) < std::abs(c.before));
}

TEST(Evidence, EffectsAreInNoiseWidths) {
  const TwinProblem problem(4);
  const Explanation e = explain(problem, {.draws = 499});
  const std::vector<double> effect = effects(problem, e);
  ASSERT_EQ(effect.size(), problem.observations().rows());
  double most = 0;
  for (std::size_t i = 0; i < effect.size(); ++i) {
    EXPECT_NEAR(effect[i], std::abs(e.residual_before[i] - e.residual_after[i]) / noise, 1e-12);
    most = std::max(most, effect[i]);
  }
  EXPECT_GT(most, 1);
}

TEST(Wording, UnitsThatPeopleUse) {
  EXPECT_EQ(quantity(0.314159, "rad"), "18 degrees");
  EXPECT_EQ(quantity(0.0031, "m"), "3.1 mm");
  EXPECT_EQ(plain_number(243.15), "243");
  EXPECT_EQ(plain_number(8.13), "8.1");
  EXPECT_EQ(estimate_in_words(-3.7e-5, 0.00033, "1"), "-0.00004 ± 0.00033");
  EXPECT_EQ(quantity(0.8, "m"), "0.8 m");
  EXPECT_EQ(quantity(2.5e-6, "m"), "2.5 µm");
  EXPECT_EQ(quantity(0.02, "s"), "20 ms");
  EXPECT_EQ(quantity(0.6, "half diagonal"), "0.6 of the half diagonal");
  EXPECT_EQ(score_in_words(0.0312, "1"), "3.1 %");
  EXPECT_EQ(score_in_words(0.253, "px"), "0.253 px");
  EXPECT_EQ(condition_in_words("surface.half-angle"), "half angle");
  EXPECT_EQ(estimate_in_words(0.0350, 0.0004, "m"), "35.0 ± 0.4 mm");
}

TEST(Wording, RangesAreOpenWhereTheyReachTheEnd) {
  LocatedCondition c{.name = "surface.half-angle", .unit = "rad"};
  c.curve.centre = {0, 0.5, 1};
  c.lower = 0, c.upper = 0.314159;
  EXPECT_EQ(range_in_words(c), "below 18 degrees");
  c.lower = 0.75, c.upper = 1;
  EXPECT_EQ(range_in_words(c), "above 43 degrees");
  c.lower = 0.25, c.upper = 0.75;
  EXPECT_EQ(range_in_words(c), "between 14 and 43 degrees");
  c.lower = 0, c.upper = 1;
  EXPECT_EQ(range_in_words(c), "");
}

}  // namespace
}  // namespace gonio::explain::tests
