// Sums that do not depend on the order of their terms, and variances found in integers.
#include "render/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"

namespace gonio::render {
namespace {

std::vector<float> many_sizes(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> values(count);
  for (float& v : values)
    v = static_cast<float>(std::ldexp(random.uniform() - 0.4, static_cast<int>(random.below(90)) - 60));
  return values;
}

struct Both {
  ExactSum sum;
  ExactSquares squares;
  bool operator==(const Both&) const = default;
};
Both sum_of(const std::vector<float>& values) {
  Both both;
  for (const float v : values) both.sum.add(v), both.squares.add(v);
  return both;
}

TEST(ExactSum, DoesNotDependOnOrderOrGrouping) {
  std::vector<float> values = many_sizes(1000, 1);
  const Both forwards = sum_of(values);
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1], values[random.below(static_cast<std::uint32_t>(i))]);
    const std::size_t cut = random.below(1000);
    Both joined = sum_of({values.begin(), values.begin() + cut});
    const Both rest = sum_of({values.begin() + cut, values.end()});
    joined.sum.add(rest.sum);
    joined.squares.add(rest.squares);
    EXPECT_EQ(joined, forwards);
  }
}

TEST(ExactSum, IsTheSumToTheLastUnit) {
  // Powers of two of both signs whose sum a double cannot hold: 2^31 + 2^-56 - 2^31 = 2^-56.
  ExactSum sum;
  sum.add(0x1p31f), sum.add(0x1p-56f), sum.add(-0x1p31f);
  EXPECT_EQ(sum.value(), 0x1p-56);
  sum.add(-0x1p-56f);
  EXPECT_EQ(sum, ExactSum());
  sum.add(0x1p-58f);  // below the unit
  sum.add(std::numeric_limits<float>::denorm_min());
  EXPECT_EQ(sum, ExactSum());
}

// Against long doubles, whose 64 bits hold sums of these squares of 12-bit numbers exactly.
TEST(ExactSum, VarianceIsTheFormulas) {
  Random random(3);
  for (const int exponent : {-40, -9, 0, 7, 19}) {
    Both both;
    long double sum = 0, squares = 0;
    constexpr std::uint32_t n = 100;
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto v = static_cast<float>(std::ldexp(static_cast<int>(random.below(4096)) - 1000, exponent));
      both.sum.add(v), both.squares.add(v);
      sum += v;
      squares += static_cast<long double>(v) * v;
    }
    const auto expected = static_cast<double>((n * squares - sum * sum) / (static_cast<long double>(n) * n * (n - 1)));
    EXPECT_NEAR(variance_of_mean(both.sum, both.squares, n), expected, 1e-14 * expected) << exponent;
    EXPECT_EQ(both.sum.value(), static_cast<double>(sum));
  }
}

TEST(ExactSum, EqualTermsHaveNoVariance) {
  for (const float v : {0.0f, 1.0f / 3, 1e-9f, -2.7e8f, 3e-38f}) {
    Both both;
    for (int i = 0; i < 1000; ++i) both.sum.add(v), both.squares.add(v);
    EXPECT_EQ(variance_of_mean(both.sum, both.squares, 1000), 0) << v;
  }
}

// A spread of one unit in the last place of a float is still told.
TEST(ExactSum, TheSmallestSpreadIsSeen) {
  Both both;
  const float v = 1e6f, next = std::nextafter(v, 2e6f);
  both.sum.add(v), both.sum.add(next), both.squares.add(v), both.squares.add(next);
  const double d = static_cast<double>(next) - v;
  EXPECT_EQ(variance_of_mean(both.sum, both.squares, 2), d * d / 4);
}

TEST(ExactSum, WhatIsNoNumberStaysNoNumber) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(), 0x1.8p31f}) {
    Both one = sum_of({1, 2}), other = sum_of({3, bad, 4});
    EXPECT_TRUE(std::isnan(other.sum.value()));
    one.sum.add(other.sum);
    one.squares.add(other.squares);
    one.sum.add(5.0f), one.squares.add(5.0f);
    EXPECT_TRUE(std::isnan(one.sum.value()));
    EXPECT_TRUE(std::isnan(variance_of_mean(one.sum, one.squares, 6)));
  }
  // More squares than there is room for: 2^19 terms of 2^31.
  Both large;
  for (int i = 0; i < 1 << 19; ++i) large.sum.add(0x1p31f), large.squares.add(0x1p31f);
  EXPECT_EQ(large.sum.value(), 0x1p50);
  EXPECT_TRUE(std::isnan(variance_of_mean(large.sum, large.squares, 1 << 19)));
}

}  // namespace
}  // namespace gonio::render
