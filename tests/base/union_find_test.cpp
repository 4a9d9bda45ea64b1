// Groups against labels that are painted over at each join.
#include "base/union_find.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace gonio {
namespace {

TEST(UnionFind, AgreesWithPaintedLabels) {
  Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const std::uint32_t n = 1 + random.below(60);
    UnionFind groups(n / 2);
    for (std::uint32_t item = n / 2; item < n; ++item) ASSERT_EQ(groups.make(), item);
    ASSERT_EQ(groups.size(), n);
    std::vector<std::uint32_t> label(n);
    std::iota(label.begin(), label.end(), 0u);
    for (std::uint32_t joins = random.below(2 * n); joins > 0; --joins) {
      const std::uint32_t a = random.below(n), b = random.below(n), la = label[a], lb = label[b];
      ASSERT_EQ(groups.join(a, b), la != lb);
      for (std::uint32_t& l : label)
        if (l == la || l == lb) l = std::min(la, lb);
    }
    for (std::uint32_t item = 0; item < n; ++item) ASSERT_EQ(groups.group(item), label[item]) << "trial " << trial;
  }
}

// A chain is the worst order: each join would deepen a tree whose paths were not shortened.
TEST(UnionFind, AMillionInAChain) {
  constexpr std::uint32_t n = 1'000'000;
  UnionFind groups(n);
  for (std::uint32_t item = n; item-- > 1;) ASSERT_TRUE(groups.join(item - 1, item));
  EXPECT_EQ(groups.group(n - 1), 0u);
  EXPECT_FALSE(groups.join(0, n / 2));
}

}  // namespace
}  // namespace gonio
