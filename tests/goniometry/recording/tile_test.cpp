// Scales of lights from readings of a white tile.
#include "goniometry/sample/tile.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace gonio::goniometry {
namespace {

TileReading reading(std::size_t view, std::size_t light, std::optional<double> time_s, double scale, double sigma) {
  return {view, light, time_s, Rgb{1, 1, 1} * scale, Rgb{1, 1, 1} * sigma};
}

TEST(Scales, TheSamePictureComesFirst) {
  const Scales scales({reading(0, 0, {}, 2, 0.1), reading(3, 0, {}, 3, 0.1), reading(4, 1, {}, 9, 0.1)});
  EXPECT_EQ(scales.at(3, 0, {})->value.x, 3);
  EXPECT_EQ(scales.at(4, 1, {})->value.x, 9);
  EXPECT_FALSE(scales.at(5, 2, {}));
}

TEST(Scales, MeansAreWeighted) {
  const TileScale mean = *Scales({reading(0, 0, {}, 2, 0.1), reading(1, 0, {}, 2.3, 0.2)}).at(7, 0, {});
  EXPECT_NEAR(mean.value.y, (4 * 2 + 2.3) / 5, 1e-12);
  EXPECT_NEAR(mean.sigma.y, 1 / std::sqrt(125), 1e-12);
  EXPECT_EQ(mean.views.size(), 2u);
}

TEST(Scales, BetweenTwoTimesTheStraightLine) {
  const Scales scales({reading(0, 0, 0, 2, 0.1), reading(1, 0, 100, 4, 0.1), reading(2, 0, 300, 4, 0.1)});
  EXPECT_NEAR(scales.at(7, 0, 25)->value.x, 2.5, 1e-12);
  EXPECT_NEAR(scales.at(7, 0, 25)->sigma.x, 0.1 * std::hypot(0.75, 0.25), 1e-12);
  EXPECT_NEAR(scales.at(7, 0, 200)->value.x, 4, 1e-12);
}

// Readings that scatter by far more than they say: the mean's sigma is that of their scatter. 400 readings: 3.5 %
// standard deviation.
TEST(Scales, ALampThatWandersWidensTheMean) {
  Random random(3);
  std::vector<TileReading> readings, steady;
  for (std::size_t i = 0; i < 400; ++i) {
    readings.push_back(reading(i, 0, {}, 5 + 0.5 * random.normal(), 0.05));
    steady.push_back(reading(i, 0, {}, 5 + 0.05 * random.normal(), 0.05));
  }
  const Scales scales(readings);
  EXPECT_NEAR(scales.at(999, 0, {})->sigma.x, 0.5 / 20, 0.15 * 0.5 / 20);
  EXPECT_NEAR(scales.wander(0)->relative, 0.1, 0.015);
  EXPECT_NEAR(scales.wander(0)->expected, 0.01, 0.001);
  EXPECT_NEAR(Scales(steady).at(999, 0, {})->sigma.x, 0.05 / 20, 1e-12);
}

}  // namespace
}  // namespace gonio::goniometry
