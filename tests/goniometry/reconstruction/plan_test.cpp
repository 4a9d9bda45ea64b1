// Plans: better than chance, reachable, ordered.
// One process: Plans.*
#include "goniometry/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "goniometry/reconstruction/small_basis.h"

namespace gonio::tests {
namespace {

using goniometry::PlannedPair;
using goniometry::PlanOptions;
using Criterion = PlanOptions::Criterion;

class Plans : public testing::Test {
 protected:
  static const goniometry::Basis& basis() {
    static const auto made = basis_of(some_materials(30));
    return made;
  }
  static std::vector<PlannedPair> random_pairs(std::size_t n, Random& random) {
    std::vector<PlannedPair> pairs;
    const double most = 80 * pi / 180;
    for (std::size_t i = 0; i < n; ++i)
      pairs.push_back({std::acos(random.uniform(std::cos(most), 1)), 0, std::acos(random.uniform(std::cos(most), 1)),
                       random.uniform(0, pi)});
    return pairs;
  }
};

TEST_F(Plans, BeatRandomDirectionsByTheirOwnMeasure) {
  for (const std::size_t n : {2u, 5u, 10u}) {
    const auto quality = [&](Criterion criterion) {
      PlanOptions options;
      options.criterion = criterion;
      return plan_quality(basis(), goniometry::plan(basis(), n, options).pairs);
    };
    const auto average = quality(Criterion::average), determinant = quality(Criterion::determinant),
               condition = quality(Criterion::condition);
    EXPECT_LE(average.sigma_ln, determinant.sigma_ln * 1.001);
    EXPECT_LE(average.sigma_ln, condition.sigma_ln * 1.001);
    EXPECT_LE(determinant.log_determinant, average.log_determinant + 1e-6);
    EXPECT_LE(condition.condition, average.condition * 1.001);
    Random random(n);
    for (int i = 0; i < 100; ++i) {
      const auto chance = plan_quality(basis(), random_pairs(n, random));
      ASSERT_LT(average.sigma_ln, chance.sigma_ln);
      ASSERT_LT(determinant.log_determinant, chance.log_determinant);
      ASSERT_LT(condition.condition, chance.condition);
    }
  }
}

TEST_F(Plans, StayWithinReach) {
  PlanOptions options;
  options.most_theta_rad = 50 * pi / 180;
  const auto plan = goniometry::plan(basis(), 15, options);
  ASSERT_EQ(plan.pairs.size(), 15u);
  for (std::size_t i = 0; i < plan.pairs.size(); ++i) {
    const PlannedPair& p = plan.pairs[i];
    EXPECT_LE(std::max(p.theta_i, p.theta_o), options.most_theta_rad + 1e-9);
    EXPECT_GE(std::acos(dot(p.wi(), p.wo())), 4.9 * pi / 180);
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(plan.pairs[k].wi() == p.wi() && plan.pairs[k].wo() == p.wo());
    EXPECT_LE(plan.sigma_ln[i], plan.sigma_ln[i > 0 ? i - 1 : 0] + 1e-9);
  }
  EXPECT_NEAR(plan.sigma_ln.back(), plan_quality(basis(), plan.pairs).sigma_ln, 1e-6);
}

// What is measured counts: the best pairs to add leave less open than pairs that were best without it, and as much as
// all rows together say.
TEST_F(Plans, AddToWhatIsMeasured) {
  const TableTruth truth(some_materials(30)[4], small_bins);
  Random random(4);
  const auto samples = measured(truth, random_pairs(8, random), 0.02, 6);
  PlanOptions options;
  options.given = &samples;
  const auto added = goniometry::plan(basis(), 4, options), fresh = goniometry::plan(basis(), 4);
  EXPECT_LT(added.sigma_ln.back(), plan_quality(basis(), fresh.pairs, options).sigma_ln);
  EXPECT_LT(added.sigma_ln.back(), fresh.sigma_ln.back());
  EXPECT_LT(added.before, fresh.before);
  EXPECT_GT(added.before, added.sigma_ln.front());
  EXPECT_NEAR(added.sigma_ln.back(), plan_quality(basis(), added.pairs, options).sigma_ln, 1e-6);
  EXPECT_NEAR(added.before, plan_quality(basis(), {}, options).sigma_ln, 1e-6);
}

TEST_F(Plans, AreWritten) {
  const auto plan = goniometry::plan(basis(), 4);
  const std::string csv = plan_csv(plan);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 5);
  const auto json = nlohmann::json::parse(plan_json(plan));
  ASSERT_EQ(json["directions"].size(), 4u);
  EXPECT_NEAR(json["directions"][2]["theta_o_rad"].get<double>(), plan.pairs[2].theta_o, 1e-6);
}

TEST_F(Plans, RefuseImpossibleNumbers) {
  EXPECT_THROW(goniometry::plan(basis(), 0), Error);
  EXPECT_THROW(goniometry::plan(basis(), 1'000'000), Error);
}

}  // namespace
}  // namespace gonio::tests
