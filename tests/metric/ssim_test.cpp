#include "metric/ssim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace gonio::metric {
namespace {

constexpr int side = 24;

struct Planes {
  std::vector<float> a, b;
  std::vector<std::uint8_t> counts;
};

Planes planes() {
  Planes p;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto a = static_cast<float>(0.5 + 0.3 * std::sin(0.7 * x + 0.2 * y) + 0.1 * ((x * 7 + y * 13) % 5) / 5.0);
      p.a.push_back(a);
      p.b.push_back(static_cast<float>(0.9 * double{a} + 0.05 + 0.08 * ((x * 3 + y * 11) % 7) / 7.0));
    }
  p.counts.assign(side * side, 1);
  return p;
}

double mean(const std::vector<float>& map) {
  double sum = 0, n = 0;
  for (const float v : map)
    if (!std::isnan(v)) sum += v, n += 1;
  return sum / n;
}

// Reference values: direct sums over two-dimensional windows in NumPy, and SciPy's gaussian_filter for a range of 1.
TEST(Ssim, AgreesWithAnIndependentImplementation) {
  const Planes p = planes();
  EXPECT_NEAR(mean(ssim_map(p.a, p.b, p.counts, side, side, 1)), 0.984395215, 1e-6);
  EXPECT_NEAR(mean(ssim_map(p.a, p.b, p.counts, side, side, 0.5)), 0.984229992, 1e-6);
  EXPECT_NEAR(ssim_map(p.a, p.b, p.counts, side, side, 1)[5 * side + 5], 0.980127093, 1e-6);
}

TEST(Ssim, ScalesWithTheRange) {
  Planes p = planes();
  const double before = mean(ssim_map(p.a, p.b, p.counts, side, side, 1));
  for (float& v : p.a) v *= 255;
  for (float& v : p.b) v *= 255;
  EXPECT_NEAR(mean(ssim_map(p.a, p.b, p.counts, side, side, 255)), before, 1e-6);
}

TEST(Ssim, OfAPictureWithItselfIsOne) {
  const Planes p = planes();
  EXPECT_NEAR(mean(ssim_map(p.a, p.a, p.counts, side, side, 1)), 1, 1e-7);
}

TEST(Ssim, LooksOnlyThroughCompleteWindows) {
  Planes p = planes();
  p.counts[0] = 0;
  p.b[0] = std::nanf("");
  const auto map = ssim_map(p.a, p.b, p.counts, side, side, 1);
  EXPECT_TRUE(std::isnan(map[5 * side + 5]));
  EXPECT_FALSE(std::isnan(map[5 * side + 6]));
  EXPECT_TRUE(std::isnan(map[4 * side + 12]));
}

TEST(Ssim, OfAPictureSmallerThanTheWindowIsUndefined) {
  const std::vector<float> a(100, 0.5f);
  const std::vector<std::uint8_t> counts(100, 1);
  for (const float v : ssim_map(a, a, counts, 10, 10, 1)) EXPECT_TRUE(std::isnan(v));
}

}  // namespace
}  // namespace gonio::metric
