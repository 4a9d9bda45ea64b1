// Sparse Cholesky factors against dense ones.
#include "linear/sparse.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/random.h"
#include "linear/solve.h"

namespace gonio::linear {
namespace {

// A'A + 1 of a random sparse A, as its lower triangle in summands, each element in two parts.
std::vector<Summand> random_lower(std::uint32_t size, std::uint64_t seed, Eigen::MatrixXd& dense) {
  Random random(seed);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
  for (std::uint32_t k = 0; k < 3 * size; ++k) a(random.below(size), random.below(size)) = random.normal();
  dense = a.transpose() * a + Eigen::MatrixXd::Identity(size, size);
  std::vector<Summand> lower;
  for (std::uint32_t i = 0; i < size; ++i)
    for (std::uint32_t j = 0; j <= i; ++j)
      if (dense(i, j) != 0) lower.insert(lower.end(), {{i, j, 0.25 * dense(i, j)}, {i, j, 0.75 * dense(i, j)}});
  return lower;
}

TEST(SparseLlt, SolvesAsTheDenseOneDoes) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Eigen::MatrixXd dense;
    std::vector<Summand> lower = random_lower(30, seed, dense);
    SparseLlt sparse(30);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(30, -1, 2);
    ASSERT_TRUE(sparse.factor(lower));
    EXPECT_LT((sparse.solve(b) - Llt(dense).solve(b)).norm(), 1e-10);
    for (Summand& s : lower) s.value *= 2;  // the same pattern
    ASSERT_TRUE(sparse.factor(lower));
    EXPECT_LT((sparse.solve(b) - 0.5 * Llt(dense).solve(b)).norm(), 1e-10);
    lower = random_lower(30, seed + 100, dense);  // another
    ASSERT_TRUE(sparse.factor(lower));
    EXPECT_LT((sparse.solve(b) - Llt(dense).solve(b)).norm(), 1e-10);
  }
}

TEST(SparseLlt, SaysWhatIsNotPositiveDefinite) {
  SparseLlt sparse(2);
  EXPECT_FALSE(sparse.factor(std::vector<Summand>{{0, 0, 1}, {1, 0, 2}, {1, 1, 1}}));
  EXPECT_TRUE(sparse.factor(std::vector<Summand>{{0, 0, 1}, {1, 0, 0.5}, {1, 1, 1}}));
}

}  // namespace
}  // namespace gonio::linear
