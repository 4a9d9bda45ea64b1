// The projection's uncertainty is honest, agrees with what brute force says, and knows distance and coverage.
#include <gtest/gtest.h>

#include <cmath>

#include "camera/quality/coverage_runs.h"
#include "camera/quality/next_views.h"

namespace gonio::camera::tests {
namespace {

// 40 calibrations of 24 points each; within one calibration the points are far from independent. 500 runs
// (scripts/proofs) must lie within 93 to 97 %; the mean over 40 runs has a standard error of 2 to 3 %.
TEST(ProjectionLaw, IntervalsHoldTheTruth) {
  const Covered c = covered(40, false);
  EXPECT_GT(c.ellipse, 0.88 * c.points);
  EXPECT_GT(c.circle, 0.88 * c.points);
  EXPECT_GT(c.focal, 0.87 * c.focals);
}

// The same views with fresh noise, forty times: the spread of the aligned projections is the law's covariance, which
// carries the poses' share too.
TEST(ProjectionLaw, AgreesWithTheSpreadOfRepeatedCalibrations) {
  constexpr int runs = 60;
  Random random(5);
  const std::vector<BoardPose> poses = world_poses(10, random);
  std::vector<Vec3> truth;
  const std::vector<View> exact = world_views(poses, 0, random);
  for (std::size_t i = 0; i < exact.size(); ++i) append_points(exact[i], world_board(), {}, poses[i], truth);
  const Vec3 points[] = {{0, 0, 0.5}, {0.25, 0.18, 0.5}, {-0.5, 0.3, 1.2}};
  double sum[3] = {}, expected[3] = {};
  for (int run = 0; run < runs; ++run) {
    const Made made = made_from(world_views(poses, 0.15, random));
    std::vector<Vec3> found;
    for (std::size_t i = 0; i < made.views.size(); ++i)
      append_points(made.views[i], world_board(), {}, made.calibration.views[i].camera_from_board, found);
    const auto motion = aligned(truth, found);
    const ProjectionLaw law(made.result());
    for (int p = 0; p < 3; ++p) {
      const Vec2 d = project(made.calibration.cameras[0].lens, motion * points[p]).value() -
                     project(world_lens(), points[p]).value();
      sum[p] += dot(d, d) / runs;
      expected[p] += law.at(points[p]).value().trace() / runs;
    }
  }
  // A mean square of 60 two-dimensional draws is known to 13 to 18 %.
  for (int p = 0; p < 3; ++p) EXPECT_NEAR(sum[p] / expected[p], 1, 0.45) << p;
}

TEST(ProjectionLaw, IsBestWhereTheBoardsWere) {
  Random random(6);
  const Made made = made_from(world_views(world_poses(12, random), 0.15, random));
  const ProjectionLaw law(made.result());
  const double there = law.at({0, 0, 0.5}).value().trace();
  EXPECT_LT(there, law.at({0, 0, 0.1}).value().trace());
  EXPECT_LT(there, law.at({0, 0, 1}, true).value().trace());
  EXPECT_LT(there, law.at({0.29, 0.21, 0.5}).value().trace());
  // Far away is the limit of farther and farther.
  EXPECT_NEAR(law.at({100, 50, 1000}).value().trace() / law.at({100, 50, 1000}, true).value().trace(), 1, 0.01);
}

TEST(ProjectionLaw, RadiusHoldsNinetyFivePercentWhateverTheShape) {
  Random random(7);
  for (const double ratio : {1.0, 0.5, 0.1, 0.0}) {
    const PixelCovariance c{1, 0, ratio * ratio};
    int inside = 0;
    for (int n = 0; n < 40000; ++n) inside += std::hypot(random.normal(), ratio * random.normal()) < radius_95(c);
    EXPECT_NEAR(inside / 40000.0, 0.95, 0.01) << ratio;
  }
}

// What it suggests must help as much as it says: the view is taken, and the map recomputed.
TEST(NextViews, ASuggestedViewLowersTheVarianceAsPromised) {
  Random random(8);
  std::vector<BoardPose> poses;
  for (int i = 0; i < 8; ++i)  // the left half only
    poses.push_back(pose_at(world_board(), {0.4 * std::cos(i), 0.4 * std::sin(i), 0.3 * i}, 0.45 + 0.02 * i,
                            {-0.9 - 0.3 * std::cos(3 * i), 0.9 * std::sin(2 * i)}));
  const Made before = made_from(world_views(poses, 0.15, random));
  const std::vector<NextView> next = next_views(before.result(), {0.6});
  ASSERT_EQ(next.size(), 3u);
  EXPECT_LT(next[0].sigma_after_px, 0.7 * next[0].sigma_before_px);
  EXPECT_NE(next[0].sentence.find("right"), std::string::npos) << next[0].sentence;
  EXPECT_GE(next[0].sigma_after_px, next[1].sigma_after_px);
  EXPECT_NE(next[0].sentence.find("tilted"), std::string::npos) << next[0].sentence;
  poses.push_back(next[0].camera_from_board);
  std::vector<View> more = before.views;
  more.push_back(world_views({poses.back()}, 0.15, random)[0]);
  ASSERT_EQ(more.back().corners.size(), 54u);
  const Made after = made_from(more);
  const auto mean_sigma = [&](const Made& made) {
    return std::sqrt(projection_map(ProjectionLaw(made.result()), made.result(), 0.6, 20).mean_variance);
  };
  EXPECT_NEAR(next[0].sigma_before_px / mean_sigma(before), 1, 1e-6);
  EXPECT_NEAR(next[0].sigma_after_px / mean_sigma(after), 1, 0.3) << next[0].sigma_before_px << " " << next[0].sentence;
}

}  // namespace
}  // namespace gonio::camera::tests
