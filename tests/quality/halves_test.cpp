// Halves of the views: they agree where the model is right, and disagree where it is not.
#include "camera/quality/halves.h"

#include <gtest/gtest.h>

#include "camera/quality/coverage.h"
#include "quality/quality_world.h"

namespace gonio::camera::tests {
namespace {

Halves halves_of(const std::vector<View>& views, bool free_warp = false) {
  return compare_halves(made_from(views, free_warp).result(), {0.5, 1.0});
}

TEST(Halves, AgreeWhereTheModelIsRight) {
  int apart = 0;
  double ratio = 0;
  for (std::uint64_t run = 0; run < 12; ++run) {
    Random random(run, 9);
    const Halves h = halves_of(world_views(world_poses(14, random), 0.15, random));
    ASSERT_TRUE(h.refused.empty()) << h.refused;
    apart += !h.agree;
    ratio += h.differ_px * h.differ_px / (h.expected_px * h.expected_px) / 12;
  }
  EXPECT_LE(apart, 1);  // at a level of 1 % two of twelve come with a chance of 0.6 %
  EXPECT_NEAR(ratio, 1, 0.6);
}

TEST(Halves, DisagreeWhereABentBoardIsTakenForFlat) {
  Random random(3, 9);
  const std::vector<BoardPose> poses = world_poses(14, random);
  const Halves h = halves_of(world_views(poses, 0.05, random, {3e-3, 2e-3}));
  EXPECT_FALSE(h.agree) << h.differ_px << " " << h.expected_px << " " << h.p;
  EXPECT_TRUE(halves_of(world_views(poses, 0.05, random, {3e-3, 2e-3}), true).agree);
}

TEST(Halves, SayWhyThereIsNoAnswer) {
  Random random(4, 9);
  const Halves h = halves_of(world_views(world_poses(5, random), 0.1, random));
  EXPECT_EQ(h.refused, "5 views are too few to halve (at least 6)");
}

TEST(Coverage, CountsTheCellsWithinTheOutlines) {
  Calibration c;
  c.views.resize(3);
  c.views[0].weight = c.views[1].weight = 1;
  const auto corner = [](int id, double x, double y) { return Corner{id, {x, y}, 0}; };
  // The left half, a triangle below the diagonal of the right half, and a dropped view over everything.
  std::vector<View> views(3);
  views[0].corners = {corner(0, 0, 0), corner(1, 639.5, 0), corner(2, 0, 960), corner(3, 639.5, 960)};
  views[1].corners = {corner(0, 639.5, 960), corner(1, 1280, 960), corner(2, 1280, 0)};
  views[2].corners = {corner(0, 0, 0), corner(1, 1280, 0), corner(2, 0, 960), corner(3, 1280, 960)};
  CalibrationSetup setup{{{}}, {{}}};
  setup.cameras[0].width_px = width, setup.cameras[0].height_px = height;
  const Coverage coverage = coverage_of({views, setup, c, 0});
  EXPECT_NEAR(coverage.share, 0.75, 0.02);
  EXPECT_EQ(picture_of(coverage).width, coverage.grid.columns);
}

}  // namespace
}  // namespace gonio::camera::tests
