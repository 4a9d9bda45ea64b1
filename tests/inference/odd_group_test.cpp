// One recording that spoils the others (inference/odd_group.h): found, set aside, said; and nobody is set aside where
// all are alike, whatever was left out.
#include "inference/odd_group.h"

#include <gtest/gtest.h>

#include "inference/engine.h"
#include "inference/nonlinear_toy.h"

namespace gonio::explain::tests {
namespace {

constexpr std::size_t odd = 4;

// A bend that is left out, and one group of ten whose readings belong to something else.
class Spoilt : public NonlinearToy {
 public:
  Spoilt(bool bent, double by, std::uint64_t seed)
      : NonlinearToy(library(), bent ? std::vector<std::vector<double>>{{1.5}} : std::vector<std::vector<double>>{},
                     {{}, 0.1, 0}, seed, {10, 40, 2}) {
    for (std::size_t i = observations_.first[odd]; i < observations_.first[odd + 1]; ++i)
      observations_.value[i] += by * std::sin(37.0 * at(0, i) + 11.0 * at(1, i));
  }
};

TEST(OddGroup, IsSetAsideAndTheOthersAreExplained) {
  const Spoilt problem(true, 40, 3);
  const Explanation e = explain(problem, {});
  ASSERT_EQ(e.odd_groups, std::vector<std::size_t>{odd}) << e.sentence;
  ASSERT_FALSE(e.named.empty()) << e.sentence;
  EXPECT_EQ(e.named[0], 0U) << e.sentence;
  EXPECT_NE(e.sentence.find("is set aside"), std::string::npos) << e.sentence;
  EXPECT_GT(e.odd_score, 10) << e.sentence;
}

TEST(OddGroup, NobodyIsSetAsideWhereAllAreAlike) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    EXPECT_TRUE(explain(Spoilt(seed % 2 == 0, 0, seed), {}).odd_groups.empty()) << seed;
}

}  // namespace
}  // namespace gonio::explain::tests
