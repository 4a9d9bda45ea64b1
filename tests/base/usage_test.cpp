// What a process says of itself: the clock, its processors, its memory.
#include "base/usage.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace gonio {
namespace {

double processor_seconds_of_this_process() {
  rusage of{};
  getrusage(RUSAGE_SELF, &of);
  return static_cast<double>(of.ru_utime.tv_sec + of.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(of.ru_utime.tv_usec + of.ru_stime.tv_usec);
}

TEST(Usage, CountsTheProcessorOfThisProcess) {
  const double before = processor_seconds_of_this_process();
  const Usage first = usage_so_far();
  double sum = 0;
  while (processor_seconds_of_this_process() < before + 0.05)
    for (int k = 1; k < 1000; ++k) sum += std::sqrt(k);
  const Usage second = usage_so_far();
  EXPECT_GT(sum, 0);
  EXPECT_GE(first.processor_seconds, before);
  EXPECT_GE(second.processor_seconds, before + 0.05);
  EXPECT_LE(second.processor_seconds, processor_seconds_of_this_process());
  EXPECT_GT(second.seconds, first.seconds);
}

TEST(Usage, ThePeakHoldsWhatWasTouchedAndDoesNotFall) {
  const double before = usage_so_far().peak_mib;
  constexpr std::size_t mib = 96;
  double with = 0;
  {
    const std::vector<char> block(mib << 20, 1);
    with = usage_so_far().peak_mib;
    EXPECT_EQ(block.back(), 1);
  }
  EXPECT_GE(with, mib);
  EXPECT_LT(with, before + mib + 64);
  EXPECT_GE(usage_so_far().peak_mib, with);
}

TEST(Usage, IsSaidSinceAMoment) {
  Usage before = usage_so_far();
  before.seconds -= 100, before.processor_seconds -= 7;
  double clock = 0, processor = 0, peak = 0;
  ASSERT_EQ(std::sscanf(usage_since(before).c_str(), "%lf s, processor %lf s, peak %lf MiB", &clock, &processor, &peak),
            3);
  EXPECT_GE(clock, 100);
  EXPECT_LT(clock, 160);
  EXPECT_GE(processor, 7);
  EXPECT_LT(processor, 67);
  EXPECT_GE(peak, std::floor(before.peak_mib));
}

}  // namespace
}  // namespace gonio
