#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/random.h"

namespace gonio {
namespace {

TEST(Parallel, EveryIndexOnceWhateverTheGrainAndTheThreads) {
  for (const int count : {1, 2, 3, 8}) {
    set_threads(count);
    EXPECT_EQ(threads(), count);
    for (const std::size_t grain : {0, 1, 7, 1000, 100000}) {
      std::vector<std::atomic<int>> visits(1003);
      parallel_for(
          3, 1003, [&](std::size_t i) { ++visits[i]; }, grain);
      for (std::size_t i = 0; i < visits.size(); ++i) EXPECT_EQ(visits[i], i < 3 ? 0 : 1);
    }
  }
  set_threads(0);
  EXPECT_GE(threads(), 1);
}

TEST(Parallel, AnEmptyRangeCallsNothing) {
  parallel_for(5, 5, [](std::size_t) { ADD_FAILURE(); });
  parallel_for(6, 5, [](std::size_t) { ADD_FAILURE(); });
}

TEST(Parallel, SameNumbersWhateverTheThreads) {
  const auto draw = [](int count) {
    set_threads(count);
    std::vector<double> result(500);
    parallel_for(
        0, result.size(),
        [&](std::size_t i) {
          Random random(42, i);
          for (int k = 0; k < 100; ++k) result[i] += random.normal();
        },
        16);
    return result;
  };
  const auto one = draw(1);
  EXPECT_EQ(one, draw(2));
  EXPECT_EQ(one, draw(5));
}

TEST(Parallel, TheLowestFailingIndexIsTheOneReported) {
  for (const int count : {1, 2, 4})
    for (int repetition = 0; repetition < 50; ++repetition) {
      set_threads(count);
      try {
        parallel_for(
            0, 1000,
            [](std::size_t i) {
              if (i % 100 == 37) throw Error(Exit::data, std::to_string(i), "fails");
            },
            10);
        ADD_FAILURE() << "no exception";
      } catch (const Error& error) {
        EXPECT_EQ(error.place(), "37");
      }
    }
}

TEST(Parallel, LoopsMayNest) {
  set_threads(3);
  std::vector<std::vector<int>> table(20, std::vector<int>(50));
  parallel_for(0, table.size(), [&](std::size_t y) {
    parallel_for(0, table[y].size(), [&](std::size_t x) { table[y][x] = static_cast<int>(x * y); });
  });
  for (std::size_t y = 0; y < table.size(); ++y)
    for (std::size_t x = 0; x < table[y].size(); ++x) EXPECT_EQ(table[y][x], static_cast<int>(x * y));
}

// Mean and variance of n = 200000 numbers against 5 standard errors: false alarm below 2e-6 for the four together.
TEST(Random, MomentsOfUniformAndNormal) {
  constexpr int n = 200000;
  Random random(1, 2);
  double u1 = 0, u2 = 0, g1 = 0, g2 = 0;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform(), g = random.normal();
    u1 += u;
    u2 += (u - 0.5) * (u - 0.5);
    g1 += g;
    g2 += g * g;
  }
  EXPECT_NEAR(u1 / n, 0.5, 5 * std::sqrt(1 / 12.0 / n));
  EXPECT_NEAR(u2 / n, 1 / 12.0, 5 * std::sqrt(1 / 180.0 / n));
  EXPECT_NEAR(g1 / n, 0, 5 * std::sqrt(1.0 / n));
  EXPECT_NEAR(g2 / n, 1, 5 * std::sqrt(2.0 / n));
}

// Streams that differ by one must not resemble each other: correlation of 10000 pairs below 5 standard errors.
TEST(Random, NeighbouringStreamsAreIndependent) {
  constexpr int n = 10000;
  for (std::uint64_t stream = 0; stream < 20; ++stream) {
    Random a(5, stream), b(5, stream + 1);
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += (a.uniform() - 0.5) * (b.uniform() - 0.5);
    EXPECT_LT(std::abs(sum / n * 12), 5 / std::sqrt(n)) << "stream " << stream;
  }
}

}  // namespace
}  // namespace gonio
