// Groups without rows, blocks without columns, models without freedom: the engine answers, and what is there is found
// as if the rest were not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "explain/engine.h"
#include "inference/toy_problem.h"
#include "linear/blocks.h"

namespace gonio::explain::tests {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Enough of them that products are made by blocks.
std::vector<ToyEffect> many_effects() {
  std::vector<ToyEffect> all = three_effects();
  for (int k = 1; k <= 50; ++k)
    all.push_back({"toy.cosine-" + std::to_string(k), [k](double, double z) { return std::cos((k + 3) * z); }});
  return all;
}

class Emptied : public ToyProblem {
 public:
  using Keep = std::function<bool(std::size_t group, std::size_t row)>;
  Emptied(const Keep& keep, std::vector<ToyEffect> effects, const Truth& truth, std::size_t groups = 10)
      : ToyProblem(std::move(effects), truth, 3, groups, 12) {
    const Observations all = observations_;
    observations_ = {};
    observations_.first.push_back(0);
    for (std::size_t g = 0; g < all.groups(); ++g) {
      for (std::size_t i = all.first[g]; i < all.first[g + 1]; ++i)
        if (keep(g, i)) add(all, i);
      observations_.group.push_back(all.group[g]);
      observations_.first.push_back(observations_.value.size());
    }
    observations_.conditions = all.conditions;
    for (std::size_t c = 0; c < all.conditions.size(); ++c) {
      observations_.conditions[c].values.clear();
      for (const std::size_t i : rows_) observations_.conditions[c].values.push_back(all.conditions[c].values[i]);
    }
  }
  Observations& recorded() { return observations_; }
  std::vector<std::size_t>& free() { return base_; }
  void forget_candidates() { candidates_.clear(); }
  std::optional<double> noise_factor(std::span<const double>) const override { return factor; }
  bool sets_outliers_aside() const override { return outliers; }
  std::optional<double> factor;
  bool outliers = false;

 private:
  void add(const Observations& all, std::size_t i) {
    observations_.value.push_back(all.value[i]);
    observations_.sigma.push_back(all.sigma[i]);
    observations_.norm.push_back(all.norm[i]);
    observations_.block.push_back(all.block[i]);
    rows_.push_back(i);
  }
  std::vector<std::size_t> rows_;
};

ToyProblem::Truth square_among(std::size_t effects) {
  ToyProblem::Truth truth;
  truth.amplitudes.assign(effects, 0.0);
  truth.amplitudes[0] = 0.8;
  return truth;
}

Options quick() {
  Options options;
  options.draws = 200;
  return options;
}

std::vector<std::string> names_of(const Problem& problem, const Explanation& e) {
  std::vector<std::string> names;
  for (const std::size_t c : e.named) names.push_back(problem.candidates()[c].id());
  return names;
}

const auto everything = [](std::size_t, std::size_t) { return true; };

TEST(Blocks, ProductsAndDecompositionsOfNothing) {
  for (const int rows : {0, 1, 3, 60, 300})
    for (const int columns : {0, 1, 5, 60, 300}) {
      if (rows * columns > 30000) continue;
      const Eigen::MatrixXd a = Eigen::MatrixXd::Random(rows, columns);
      EXPECT_LT((linear::gram_of(a) - a.transpose() * a).squaredNorm(), 1e-18);
      EXPECT_EQ(linear::basis_of(a).cols(), std::min(rows, columns));
      EXPECT_EQ(linear::basis_of(a).rows(), rows);
      const Eigen::VectorXd outside = linear::lengths_outside(a, Eigen::MatrixXd::Ones(rows, 2));
      ASSERT_EQ(outside.size(), 2);
      EXPECT_NEAR(outside[1],
                  rows <= columns
                      ? 0
                      : (Eigen::VectorXd::Ones(rows) -
                         linear::basis_of(a) * (linear::basis_of(a).transpose() * Eigen::VectorXd::Ones(rows)))
                            .norm(),
                  1e-9);
      const linear::EigenPairs eigen = linear::eigen_of(linear::gram_of(a));
      EXPECT_EQ(eigen.values.size(), columns);
      EXPECT_NEAR(eigen.values.sum(), a.squaredNorm(), 1e-9 * (1 + a.squaredNorm()));
      EXPECT_EQ(eigen.largest() > 0, a.size() > 0);
    }
}

// The first group, the last, several: their numbers stay free, and nothing else changes.
TEST(Degenerate, GroupsWithoutRowsTakeNoPart) {
  const Emptied whole([](std::size_t g, std::size_t) { return g < 7; }, three_effects(), square_among(3));
  const Explanation expected = explain(whole, quick());
  ASSERT_THAT(names_of(whole, expected), ElementsAre("toy.square"));
  EXPECT_THAT(expected.sentence, HasSubstr("Groups group-7, group-8 and group-9 take no part"));
  EXPECT_EQ(expected.groups.size(), 7u);
  for (const std::vector<std::size_t>& gone : {std::vector<std::size_t>{0}, {9}, {0, 4, 5, 9}}) {
    const Emptied p([&](std::size_t g, std::size_t) { return std::ranges::count(gone, g) == 0; }, many_effects(),
                    square_among(53));
    const Explanation e = explain(p, quick());
    EXPECT_THAT(names_of(p, e), ElementsAre("toy.square"));
    EXPECT_EQ(e.groups.size(), 10 - gone.size());
    const std::string said = gone.size() == 1
                                 ? "Group group-" + std::to_string(gone[0]) + " takes no part: all that it shows"
                                 : "Groups group-0, group-4, group-5 and group-9 take no part";
    EXPECT_THAT(e.sentence, HasSubstr(said));
  }
}

TEST(Degenerate, AmongManyGroupsNoneWithoutRowsIsSetAsideForTheLastTest) {
  const Emptied p([](std::size_t g, std::size_t) { return g % 3 != 0; }, three_effects(), square_among(3), 30);
  const Explanation e = explain(p, quick());
  EXPECT_EQ(e.test_groups.size(), 5u);
  for (const std::size_t g : e.test_groups) EXPECT_NE(g % 3, 0u);
  EXPECT_THAT(names_of(p, e), ElementsAre("toy.square"));
}

TEST(Degenerate, OneGroupOrOneBlockOrOneRowIsLittleToGoBy) {
  for (const std::size_t rows : {24u, 2u, 1u}) {
    const Emptied p([&](std::size_t g, std::size_t i) { return g == 4 && i < 96 + rows; }, many_effects(),
                    square_among(53));
    const Explanation e = explain(p, quick());
    EXPECT_TRUE(e.named.empty()) << rows;
    EXPECT_FALSE(e.sentence.empty());
  }
}

TEST(Degenerate, NoRowAtAllIsRefused) {
  const Emptied p([](std::size_t, std::size_t) { return false; }, three_effects(), square_among(3));
  try {
    explain(p, quick());
    FAIL() << "was explained";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), HasSubstr("toy: not one of the observations of 10 groups counts; look for masks"));
  }
  EXPECT_THROW(null_test(p, quick()), Error);
}

TEST(Degenerate, AHalfWithoutBlocks) {
  // One block of two rows in some groups: it lies in one half, and the other is empty.
  const Emptied p([](std::size_t g, std::size_t i) { return g % 2 == 0 || i % 24 < 2; }, many_effects(),
                  square_among(53));
  const Explanation e = explain(p, quick());
  EXPECT_FALSE(e.sentence.empty());
}

TEST(Degenerate, NothingIsFree) {
  Emptied p(everything, many_effects(), square_among(53));
  p.free().clear();
  EXPECT_FALSE(explain(p, quick()).sentence.empty());
  Emptied slope(everything, many_effects(), square_among(53));  // and groups that no free number touches
  slope.free() = {1, 2, 3};
  EXPECT_FALSE(explain(slope, quick()).sentence.empty());
}

TEST(Degenerate, NothingIsKnown) {
  Emptied p([](std::size_t g, std::size_t) { return g != 2; }, many_effects(), square_among(53));
  p.forget_candidates();
  EXPECT_TRUE(explain(p, quick()).named.empty());
  Options none = quick();
  none.negative_controls = 0;
  p.recorded().conditions.clear();
  EXPECT_TRUE(explain(p, none).named.empty());
}

TEST(Degenerate, ConditionsThatSayNothing) {
  Emptied p(everything, three_effects(), square_among(3));
  const std::vector<double> nothing(p.recorded().rows(), std::numeric_limits<double>::quiet_NaN());
  p.recorded().conditions.push_back({"nothing", "m", "toy", nothing, {}});
  p.recorded().conditions.push_back({"constant", "m", "toy", std::vector<double>(nothing.size(), 4.0), {}});
  EXPECT_THAT(names_of(p, explain(p, quick())), ElementsAre("toy.square"));
}

TEST(Degenerate, ReadingsThatAreAllTheSame) {
  Emptied p(everything, many_effects(), square_among(53));
  for (double& v : p.recorded().value) v = 0;
  for (double& v : p.recorded().norm) v = 0;
  const Explanation e = explain(p, quick());
  EXPECT_TRUE(e.named.empty()) << e.sentence;
}

// A group all of whose blocks are far out is set aside whole.
TEST(Degenerate, AGroupThatIsSetAsideWhole) {
  Emptied p(everything, three_effects(), square_among(3));
  p.outliers = true;
  Random random(9);
  for (std::size_t i = p.recorded().first[3]; i < p.recorded().first[4]; ++i)
    p.recorded().value[i] += 1e4 * random.normal();
  const Explanation e = explain(p, quick());
  EXPECT_GE(e.outlier_blocks, 10u);
  EXPECT_FALSE(e.sentence.empty());
}

}  // namespace
}  // namespace gonio::explain::tests
