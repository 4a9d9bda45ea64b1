// Readings that stand out (inference/outliers.h): counted where they are, by their places; none in Gaussian noise, none
// where a domain takes them for mistakes; and a mismatch that is in them alone is no "nothing that matters".
#include "inference/outliers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "inference/engine.h"
#include "inference/fit.h"
#include "inference/nonlinear_toy.h"

namespace gonio::explain::tests {
namespace {

constexpr double noise = 0.1, height = 2;

// Every fortieth reading or so is off, on either side in turn: no curve over x or z follows.
double speckle(double x, double z) {
  const double turn = std::sin(7919 * x + 104729 * z);
  return turn > 0.997 ? height : turn < -0.997 ? -height : 0;
}

class Scene : public NonlinearToy {
 public:
  Scene(bool spoiled, std::uint64_t seed)
      : NonlinearToy(library(), {}, {spoiled ? speckle : std::function<double(double, double)>{}, noise, 0}, seed,
                     {10, 40, 2}) {}
  bool outliers_are_effects() const override { return true; }
};

std::optional<Outliers> found_in(const Problem& problem) {
  const System system(problem, 1);
  const Fit base = fit(system, std::vector<double>(problem.parameters().size(), 0.0), problem.base());
  return outliers(system, base.values);
}

TEST(Outliers, AreThoseThatWerePutInAndTheirShare) {
  const Scene scene(true, 5);
  const Observations& o = scene.observations();
  std::size_t put_in = 0;
  for (std::size_t i = 0; i < o.rows(); ++i)
    put_in += speckle(o.conditions[0].values[i], o.conditions[1].values[i]) != 0;
  ASSERT_GT(put_in, 10U);
  const std::optional<Outliers> found = found_in(scene);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->readings, put_in);
  EXPECT_LE(found->places, put_in);
  std::size_t in_groups = 0;
  for (const auto& [group, readings] : found->of_groups) in_groups += readings;
  EXPECT_EQ(in_groups, put_in);
  EXPECT_TRUE(
      std::ranges::is_sorted(found->of_groups, [](const auto& a, const auto& b) { return a.second > b.second; }));
  const double power = static_cast<double>(put_in) * height * height / (noise * noise * static_cast<double>(o.rows()));
  EXPECT_NEAR(found->power, power, 0.15 * power);
}

TEST(Outliers, AreNotSeenInNoise) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) EXPECT_FALSE(found_in(Scene(false, seed)).has_value()) << seed;
}

// Rows whose place excuses all that was put in are none; where it excuses a half, the rest of them stands out.
TEST(Outliers, AreWhatIsLeftWhenTheirPlaceMayBeALittleElsewhere) {
  class Excused : public Scene {
   public:
    explicit Excused(double most) : Scene(true, 5) { observations_.place_error.assign(observations_.rows(), most); }
  };
  EXPECT_FALSE(found_in(Excused(height)).has_value());
  const std::optional<Outliers> all = found_in(Scene(true, 5)), half = found_in(Excused(height / 2));
  ASSERT_TRUE(all && half);
  EXPECT_EQ(half->readings, all->readings);
  EXPECT_NEAR(half->power, all->power / 4, 0.1 * all->power);
  EXPECT_NEAR(half->effect, all->effect / 4, 0.1 * all->effect);
}

TEST(Outliers, AreMistakesToADomainThatDoesNotCallThemEffects) {
  EXPECT_FALSE(found_in(NonlinearToy(library(), {}, {speckle, noise, 0}, 5, {10, 40, 2})).has_value());
}

TEST(Outliers, OfAMismatchThatNothingFollowsAreSomethingOutside) {
  Options options;
  options.smallest_effect = 0.05;
  const Explanation e = explain(Scene(true, 7), options);
  EXPECT_EQ(e.verdict, Verdict::unknown) << e.sentence;
  EXPECT_GT(e.probability, 0.5);
  EXPECT_NE(e.sentence.find("few readings that stand out"), std::string::npos) << e.sentence;
}

// An edge that stands elsewhere, as a shadow's does: beside it readings are far off, and what its slope at the base
// model promises for other groups is worse than nothing.
class MovedEdge : public NonlinearToy {
 public:
  explicit MovedEdge(std::uint64_t seed)
      : NonlinearToy(with_edge(), {{}, {}, {}, {}, {}, {}, {}, {shift}}, {{}, noise, 0}, seed, {10, 40, 2}) {}
  bool outliers_are_effects() const override { return true; }
  static constexpr double shift = 0.045;
  static std::vector<Effect> with_edge() {
    std::vector<Effect> all = library();
    all.push_back({"toy.edge", {number("shift", 0, -0.2, 0.2, 0.002)}, {"x"}, [](Numbers p, double x, double) {
                     const auto lit = [](double at) { return 0.5 * height * std::tanh(at / 0.002); };
                     return lit(x - 0.3) - lit(x - 0.3 - p[0]);
                   }});
    return all;
  }
};

TEST(Outliers, BesideAnEdgeThatStandsElsewhereAreExplained) {
  int named = 0;
  const int runs = 6;
  std::string missed;
  for (std::uint64_t seed = 0; seed < runs; ++seed) {
    const MovedEdge problem(seed);
    Options options;
    options.smallest_effect = 0.05;
    const Explanation e = explain(problem, options);
    const bool right = e.named.size() == 1 && problem.candidates()[e.named[0]].id() == "toy.edge";
    named += right && std::abs(e.values[problem.candidates()[e.named[0]].parameters[0]] - MovedEdge::shift) < 0.01;
    if (!right) missed += e.sentence + "\n";
  }
  EXPECT_GE(named, runs - 1) << missed;
}

}  // namespace
}  // namespace gonio::explain::tests
