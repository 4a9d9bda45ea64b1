// Bits of samples above a threshold, and the window of slices that holds them.
#include "volume/sample_window.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "volume/surfaces.h"

namespace gonio::volume {
namespace {

TEST(SampleWindow, BitsOfRowsOfAnyLength) {
  Random random(11);
  for (std::size_t count = 1; count < 200; ++count) {
    std::vector<float> values(count);
    for (float& v : values) v = static_cast<float>(random.below(3));
    const std::size_t words = (count + 2) / 64 + 1;
    std::vector<std::uint64_t> bits(words, ~std::uint64_t{0});
    bits_above(values.data(), count, 1, bits.data(), words);
    for (std::size_t n = 0; n < 64 * words; ++n) {
      const bool above = n > 0 && n <= count && values[n - 1] > 1;
      ASSERT_EQ((bits[n / 64] >> (n % 64) & 1) != 0, above) << count << " " << n;
    }
  }
}

TEST(SampleWindow, FloatsCompareAsTheDoubleDoes) {
  for (const double threshold : {0.1, 1.0 / 3, 0.5, -0.1, 16777217.0, 1e-50, -1e-50}) {
    const float limit = float_threshold(threshold);
    for (float v : {std::nextafter(limit, -1e30f), limit, std::nextafter(limit, 1e30f)})
      EXPECT_EQ(v > limit, static_cast<double>(v) > threshold) << threshold;
  }
}

TEST(SampleWindow, KeepsTheLastSlices) {
  for (const int count : {1, 2}) {
    set_threads(count);
    tests::MemoryVolume volume({2, 1, 101}, [](double i, double, double k) { return 2 * k + i; });
    SampleWindow window(volume, 99.5, 4);
    for (std::size_t k = 0; k < 101; ++k) {
      window.advance_to(k);
      for (std::size_t back = 0; back < 4 && back <= k; ++back) {
        EXPECT_EQ(window.row(0, k - back)[1], 2 * static_cast<float>(k - back) + 1);
        EXPECT_EQ(*window.bits(1, k - back + 1), k - back >= 50 ? 6u : 0u);  // slice 49 has 98 and 99
      }
      EXPECT_EQ(*window.bits(0, k + 1), 0u);
      EXPECT_EQ(*window.bits(2, k + 1), 0u);
    }
    EXPECT_EQ(*window.bits(1, 0), 0u);
    EXPECT_EQ(*window.bits(1, 102), 0u);
  }
  set_threads(0);
}

}  // namespace
}  // namespace gonio::volume
