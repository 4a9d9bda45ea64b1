#include "optim/descent.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "optim/damped.h"

namespace gonio::optim {
namespace {

// cost(x) along a line, with a model that may be told to lie.
struct Line final : Descent {
  explicit Line(double start) : x(start) {}
  virtual double cost_at(double at) const { return (at - 3) * (at - 3); }
  void linearise() override { ++linearised; }
  Proposal propose(double damping) override {
    asked.push_back(damping);
    const double g = 2 * (3 - x), step = g / (2 * (1 + damping));
    there = x + step * exaggeration;
    return {boast * (g * step - step * step), std::abs(step * exaggeration)};
  }
  double evaluate() override {
    return wall && there > *wall ? std::numeric_limits<double>::quiet_NaN() : cost_at(there);
  }
  void accept() override { x = there; }
  double x, there = 0, exaggeration = 1, boast = 1;
  std::optional<double> wall;
  std::vector<double> asked;
  int linearised = 0;
};

TEST(Descent, StopsForTheReasonThatItGives) {
  Limits limits;
  limits.first_damping = 0;
  limits.least_damping = 0;
  {
    Line line(10);
    limits.floor = 1e-20;
    EXPECT_EQ(descend(line, line.cost_at(line.x), limits).stop, Stop::floor);
    EXPECT_DOUBLE_EQ(line.x, 3);
    limits.floor = -HUGE_VAL;
  }
  {
    Line line(10);
    limits.first_damping = 1;  // half the way, then ever more of it
    limits.small_fall = {};
    limits.small_promise = {0, 1e-3};
    const Descended d = descend(line, line.cost_at(line.x), limits);
    EXPECT_EQ(d.stop, Stop::promise);
    EXPECT_NEAR(line.x, 3, std::sqrt(1e-3));
    limits.small_promise = {};
    limits.small_step = 0.1;
    Line again(10);
    EXPECT_EQ(descend(again, again.cost_at(again.x), limits).stop, Stop::step);
    limits.small_step = 0;
    limits.small_fall = {0.99, 0};
    Line third(10);
    EXPECT_EQ(descend(third, third.cost_at(third.x), limits).stop, Stop::fall);
    limits.most_steps = 2;
    limits.small_fall = {};
    Line fourth(10);
    const Descended cut = descend(fourth, fourth.cost_at(fourth.x), limits);
    EXPECT_EQ(cut.stop, Stop::steps);
    EXPECT_FALSE(cut.settled());
    EXPECT_EQ(cut.steps, 2);
  }
}

TEST(Descent, AWayUpIsRefusedAndTheDampingGrowsEverFaster) {
  Line line(10);
  line.exaggeration = -1;
  Limits limits;
  limits.first_damping = 1;
  limits.most_refusals = 5;
  const Descended d = descend(line, line.cost_at(line.x), limits);
  EXPECT_EQ(d.stop, Stop::barren);
  EXPECT_FALSE(d.settled());
  EXPECT_EQ(line.x, 10);
  EXPECT_EQ(line.linearised, 1);
  EXPECT_EQ(line.asked, (std::vector<double>{1, 2, 8, 64, 1024}));
}

TEST(Descent, WhatIsRefusedBelowRoundingIsAtRest) {
  Line line(3 + 1e-9);
  line.exaggeration = -1;
  Limits limits;
  limits.rounding = {0, 1e-12};
  const Descended d = descend(line, line.cost_at(line.x), limits);
  EXPECT_EQ(d.stop, Stop::rounding);
  EXPECT_TRUE(d.settled());
}

TEST(Descent, NoPlaceToBeIsNeverGoneTo) {
  Line line(0);
  line.wall = 2.5;
  const Descended d = descend(line, line.cost_at(line.x), {});
  EXPECT_LE(line.x, 2.5);
  EXPECT_GT(line.x, 2.4);
  EXPECT_EQ(d.cost, line.cost_at(line.x));
}

// A tiny step under heavy damping says nothing about how near the minimum is.
TEST(Descent, AHeavilyDampedCrawlIsNotRest) {
  Limits limits;
  limits.first_damping = 1e8;
  limits.small_fall = {1e-6, 0};
  limits.most_steps = 500;
  Line line(10);
  EXPECT_EQ(descend(line, line.cost_at(line.x), limits).steps, 1);
  limits.calm_damping = 1e-2;
  Line patient(10);
  EXPECT_TRUE(descend(patient, patient.cost_at(patient.x), limits).settled());
  EXPECT_NEAR(patient.x, 3, 1e-2);
}

// A promise that is never kept, as by a slope along a kink: steps are taken all the same, and the damping is not to
// rise until none of them matters.
TEST(Descent, AStepThatIsTakenNeverRaisesTheDamping) {
  Line line(10);
  line.boast = 30;
  Limits limits;
  limits.first_damping = 1;
  limits.small_fall = {0, 1e-12};
  limits.rounding = {};
  limits.most_steps = 60;
  const Descended d = descend(line, line.cost_at(line.x), limits);
  EXPECT_TRUE(std::ranges::is_sorted(line.asked, std::greater<>())) << line.asked.back();
  EXPECT_EQ(d.stop, Stop::fall);
  EXPECT_NEAR(line.x, 3, 1e-6);
}

// Residuals that are linear keep every promise exactly, also for a step that a bound has cut.
TEST(Damped, APromiseIsOfTheStepThatIsTaken) {
  Eigen::MatrixXd j(4, 2);
  j << 1, 2, -1, 3, 0.5, 1, 2, -1;
  const Eigen::Vector4d r(1, -2, 3, 0.5);
  const Eigen::MatrixXd h = j.transpose() * j;
  const Eigen::VectorXd downhill = -(j.transpose() * r);
  const auto step = damped_step(h, downhill, 0.3);
  const auto fall = [&](const Eigen::VectorXd& change) { return r.squaredNorm() - (r + j * change).squaredNorm(); };
  EXPECT_NEAR(step.promised, fall(step.change), 1e-12);
  EXPECT_NEAR(promised_fall(h, downhill, step.change), step.promised, 1e-12);
  Eigen::VectorXd cut = step.change;
  cut[1] *= 0.25;
  EXPECT_NEAR(promised_fall(h, downhill, cut), fall(cut), 1e-12);
  EXPECT_GT(std::abs(step.promised - fall(cut)), 1e-3);
  Eigen::MatrixXd lower = h;
  lower(0, 1) = 1e9;  // only the lower triangle is read
  EXPECT_NEAR(promised_fall(lower, downhill, cut), fall(cut), 1e-12);
}

TEST(Descent, EveryReasonHasItsOwnWords) {
  std::set<std::string> words;
  for (int s = 0; s <= static_cast<int>(Stop::steps); ++s) {
    Descended d;
    d.steps = 2;
    d.stop = static_cast<Stop>(s);
    EXPECT_TRUE(sentence(d).starts_with("stopped after 2 steps: ")) << sentence(d);
    words.insert(sentence(d));
  }
  EXPECT_EQ(words.size(), 7u);
}

}  // namespace
}  // namespace gonio::optim
