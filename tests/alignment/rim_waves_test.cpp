#include "alignment/rim_waves.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gonio::alignment {
namespace {

Fitted left_behind(Question& q, double mean_px, double weight) {
  q.sightings.push_back({});
  Fitted f;
  f.sightings.push_back({});
  for (int i = 0; i < 320; ++i) {
    q.sightings[0].points.push_back({{1.0 * i, 0}, {0, 1}, 0.3, 0, 1.0 * i, true});
    f.sightings[0].offset_px.push_back(mean_px * (i / 32 % 2 ? 1 : -1)), f.sightings[0].weight.push_back(weight);
  }
  return f;
}

TEST(RimWaves, AreHeldAgainstWhatMasksMake) {
  Question low, high, spoiled;
  const RimWaves small = rim_waves(low, left_behind(low, 0.2, 1), 0);
  EXPECT_NEAR(small.rms_px, 0.2, 1e-12);
  EXPECT_NEAR(small.limit_px, 0.3 * std::sqrt(0.5 * 29.588 / 10), 1e-4);  // 99.9 % of chi-square, 10 degrees
  EXPECT_FALSE(small.beyond());
  const Fitted left = left_behind(high, 0.4, 1);
  EXPECT_TRUE(rim_waves(high, left, 0).beyond());
  EXPECT_FALSE(rim_waves(high, left, 0, 1.5).beyond());  // masks that may be twice as coarse
  EXPECT_EQ(rim_waves(spoiled, left_behind(spoiled, 0.4, 0.1), 0).pieces, 0U);
}

}  // namespace
}  // namespace gonio::alignment
