// The random numbers of paths: nets within a pass, independence among passes and dimensions. False-alarm rates are
// stated for fixed seeds, which make every run the same.
#include "render/sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace gonio::render {
namespace {

// Pairs 0 .. dimensions - 1 of samples 0 .. count - 1 of a pass.
std::vector<std::vector<Vec2>> draw(std::uint64_t seed, std::uint64_t stream, int count, int dimensions) {
  std::vector<std::vector<Vec2>> pairs(dimensions);
  for (int i = 0; i < count; ++i) {
    Sampler sampler(seed, stream, i);
    for (auto& dimension : pairs) dimension.push_back(sampler.two());
  }
  return pairs;
}

// Every elementary interval of area 2^-m holds exactly one of 2^m points; Niederreiter 1987, definition of (0, m, 2)
// nets. The first 2^m samples of a pass are a net for every m, and so is each further block of 2^m.
TEST(Sampler, EveryBlockOfAPowerOfTwoIsANet) {
  for (const std::uint64_t stream : {0u, 7u, 123456u})
    for (const auto& points : draw(5, stream, 1024, 3))
      for (int m = 0; m <= 10; ++m)
        for (int block = 0; block < 1024 >> m; ++block)
          for (int across = 0; across <= m; ++across) {
            std::set<std::pair<int, int>> cells;
            for (int i = block << m; i < (block + 1) << m; ++i)
              cells.insert({static_cast<int>(std::ldexp(points[i].x, across)),
                            static_cast<int>(std::ldexp(points[i].y, m - across))});
            ASSERT_EQ(cells.size(), std::size_t{1} << m) << "block " << block << " of 2^" << m;
          }
}

TEST(Sampler, NumbersLieInsideTheUnitInterval) {
  for (std::uint64_t stream = 0; stream < 2000; ++stream)
    for (const auto& points : draw(1, stream, 2, 20))
      for (const Vec2 u : points) {
        ASSERT_GT(u.x, 0);
        ASSERT_LT(u.x, 1);
        ASSERT_GT(u.y, 0);
        ASSERT_LT(u.y, 1);
      }
}

// Single points over streams: chi-square in 16 x 16 cells, 255 degrees of freedom, of 20 dimensions. The largest of 20
// exceeds 255 + 5 sqrt(2 * 255) = 368 by chance once in 2000 sets.
TEST(Sampler, IsUniformOverStreams) {
  constexpr int streams = 25600;
  std::vector<std::array<int, 256>> counts(20);
  for (auto& cells : counts) cells.fill(0);
  for (int stream = 0; stream < streams; ++stream) {
    Sampler sampler(11, stream, 0);
    for (auto& cells : counts) {
      const Vec2 u = sampler.two();
      ++cells[static_cast<int>(u.y * 16) * 16 + static_cast<int>(u.x * 16)];
    }
  }
  for (const auto& cells : counts) {
    double chi_square = 0;
    for (const int n : cells) chi_square += (n - 100.0) * (n - 100.0) / 100;
    EXPECT_LT(chi_square, 368);
    EXPECT_GT(chi_square, 160);
  }
}

// Correlations of pass sums between dimensions, and of single numbers between dimensions, passes and pixels: under
// independence z is standard normal. 2 * 190 + 40 tests, limit 4.5: 0.3 % by chance.
TEST(Sampler, DimensionsPassesAndPixelsAreUncorrelated) {
  constexpr int streams = 20000, numbers = 20, count = 4;
  std::vector<std::vector<double>> first(numbers, std::vector<double>(streams)), sums = first;
  for (int stream = 0; stream < streams; ++stream) {
    const auto pairs = draw(3, stream, count, numbers / 2);
    for (int d = 0; d < numbers; ++d) {
      const auto value = [&](int i) { return (d % 2 == 0 ? pairs[d / 2][i].x : pairs[d / 2][i].y) - 0.5; };
      first[d][stream] = value(0);
      // What a pass makes of an integrand that is not linear.
      for (int i = 0; i < count; ++i) sums[d][stream] += std::cos(9 * value(i)) / count;
    }
  }
  const auto z = [](const std::vector<double>& a, const std::vector<double>& b, int lag) {
    const int n = static_cast<int>(a.size()) - lag;
    double ma = 0, mb = 0, ab = 0, aa = 0, bb = 0;
    for (int i = 0; i < n; ++i) ma += a[i] / n, mb += b[i + lag] / n;
    for (int i = 0; i < n; ++i) {
      ab += (a[i] - ma) * (b[i + lag] - mb);
      aa += (a[i] - ma) * (a[i] - ma);
      bb += (b[i + lag] - mb) * (b[i + lag] - mb);
    }
    return ab / std::sqrt(aa * bb) * std::sqrt(n);
  };
  for (int a = 0; a < numbers; ++a) {
    for (int b = 0; b < a; ++b) {
      EXPECT_LT(std::abs(z(first[a], first[b], 0)), 4.5) << a << ", " << b;
      EXPECT_LT(std::abs(z(sums[a], sums[b], 0)), 4.5) << a << ", " << b;
    }
    EXPECT_LT(std::abs(z(first[a], first[a], 1)), 4.5) << a;
    EXPECT_LT(std::abs(z(sums[a], sums[a], 1)), 4.5) << a;
  }
}

// The mean of a smooth function over n samples: random numbers err by n^-1/2, nets that are scrambled by Owen's method
// by n^-3/2 (Owen 1997, "Scrambled net variance for integrals of smooth functions"). From 16 to 1024 samples that is a
// factor of 8 against 512; at least 150 is demanded, from 400 streams (relative standard deviation of an rms 3.5 %).
TEST(Sampler, ConvergesFasterThanRandomNumbers) {
  const auto integrand = [](Vec2 u) { return std::exp(u.x) * std::sin(2 * u.y + 1); };
  const double exact = (std::exp(1.0) - 1) * (std::cos(1.0) - std::cos(3.0)) / 2;
  const auto rms = [&](int count) {
    double sum = 0;
    for (int stream = 0; stream < 400; ++stream) {
      double mean = 0;
      const auto pairs = draw(9, stream, count, 4);
      for (const Vec2 u : pairs[3]) mean += integrand(u) / count;
      sum += (mean - exact) * (mean - exact) / 400;
    }
    return std::sqrt(sum);
  };
  const double coarse = rms(16), fine = rms(1024);
  RecordProperty("ratio", std::to_string(coarse / fine));
  EXPECT_GT(coarse / fine, 150);
  const double sigma = 0.6;  // of the integrand, to a tenth: what random numbers would do
  EXPECT_LT(coarse, 0.35 * sigma / 4);
}

// The second dimension by its definition: direction numbers of the polynomial x + 1 (Bratley & Fox 1988).
TEST(Sampler, TwoSamplesOfOneBitAreTheFourQuarters) {
  std::array<int, 4> quarters{};
  for (int stream = 0; stream < 4000; ++stream) {
    const auto points = draw(2, stream, 2, 1)[0];
    // In a net of two points the halves differ in both coordinates.
    EXPECT_NE(points[0].x < 0.5, points[1].x < 0.5);
    EXPECT_NE(points[0].y < 0.5, points[1].y < 0.5);
    ++quarters[(points[0].x < 0.5 ? 0 : 1) + (points[0].y < 0.5 ? 0 : 2)];
  }
  for (const int n : quarters) EXPECT_NEAR(n, 1000, 130);  // 4.7 standard deviations
}

}  // namespace
}  // namespace gonio::render
