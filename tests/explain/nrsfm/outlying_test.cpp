// The test of single observations: its false alarms, what it finds, and what it must not take for outliers.
#include <gtest/gtest.h>

#include "nrsfm/solve/outliers.h"
#include "tracks_world.h"

namespace gonio::nrsfm {
namespace {

using gonio::explain::testing::film;
using gonio::explain::testing::Film;
using gonio::explain::testing::known;
using gonio::explain::testing::Sequence;
using gonio::explain::testing::solved;

std::size_t alarms(Film f, int films, double false_alarm, bool free_scales = false) {
  std::size_t found = 0;
  for (int k = 0; k < films; ++k) {
    f.seed = 1000 + static_cast<std::uint64_t>(k);
    found += find_outliers(known(film(f), free_scales), false_alarm).found > 0;
  }
  return found;
}

// 40 films each at 5 %: more than 6 have a chance of 0.3 %.
TEST(Outliers, FalseAlarmsAreAsRareAsStated) {
  EXPECT_LE(alarms({}, 40, 0.05), 6u);
}

TEST(Outliers, WhatTheCameraLeavesOutIsNoOutlier) {
  Film near, zoomed;
  near.inverse_focal = 3e-4, zoomed.zoom = 0.05;
  EXPECT_LE(alarms(near, 40, 0.05), 6u);
  EXPECT_LE(alarms(zoomed, 40, 0.05), 6u);
}

TEST(Outliers, WhatTheBasisLacksIsNoOutlier) {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Film f;
    f.shapes = 3, f.seed = 2000 + seed, f.points = 40;
    const Outliers o = find_outliers(solved(film(f), "pta", {{"terms", 2}}), 0.05);
    found += o.found > 0;
    EXPECT_LT(o.noise, 2 * f.noise_px);
  }
  EXPECT_LE(found, 4u);  // 5 %: more have a chance of 0.3 %
}

// Slips of ten noise widths, single and in runs, one observation in fifty.
TEST(Outliers, SlipsAreFoundWithTheirSizes) {
  std::size_t planted = 0, found = 0, wrong = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Film f;
    f.seed = 3000 + seed, f.frames = 30;
    Sequence s = film(f);
    Random random(seed);
    Eigen::ArrayXXd slipped = Eigen::ArrayXXd::Zero(f.frames, f.points);
    for (int k = 0; k < 6; ++k) {
      const Eigen::Index p = 3 * k + 1, first = random.below(26), length = k % 2 == 0 ? 1 : 4;
      const double angle = 6.28 * random.uniform();
      const Eigen::Vector2d slip = 10 * f.noise_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      for (Eigen::Index t = first; t < first + length; ++t) {
        s.tracks.block<2, 1>(2 * t, p) += slip;
        slipped(t, p) = 1;
      }
    }
    const Outliers o = find_outliers(known(s), 0.01);
    planted += static_cast<std::size_t>(slipped.sum());
    for (const gonio::nrsfm::Run& run : o.runs)
      for (std::size_t t = run.first; t <= run.last; ++t) (slipped(t, run.point) > 0 ? found : wrong) += 1;
    EXPECT_NEAR(o.rms_offset, 10 * f.noise_px, 2 * f.noise_px);
  }
  EXPECT_GE(found, planted * 95 / 100) << planted;
  EXPECT_LE(wrong, 3u);
}

// From frame 12 on it follows another spot.
TEST(Outliers, ATrackThatSlippedHalfWayIsNotPassedOver) {
  Film f;
  f.shapes = 1;
  Sequence s = film(f);
  for (Eigen::Index t = 12; t < 20; ++t) s.tracks.block<2, 1>(2 * t, 5) += Eigen::Vector2d(6, -6);
  const Outliers o = find_outliers(known(s), 0.01);
  ASSERT_FALSE(o.runs.empty());
  for (const gonio::nrsfm::Run& run : o.runs) EXPECT_EQ(run.point, 5u);
  EXPECT_GE(o.found, 6u);
}

}  // namespace
}  // namespace gonio::nrsfm
