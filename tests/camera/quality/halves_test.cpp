// Halves of the views: they agree where the model is right, and disagree where it is not.
#include "camera/quality/halves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "camera/quality/coverage.h"
#include "camera/quality/quality_world.h"

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

// A bent board taken for flat moves the lens by many times what the corners' noise explains. The scatter between shots
// knows it: the covariance is widened until it covers the halves' difference, and shrinks again when the bend is
// fitted.
TEST(Halves, ABentBoardTakenForFlatWidensTheUncertainty) {
  Random random(3, 9);
  const std::vector<BoardPose> poses = world_poses(14, random);
  const Made flat = made_from(world_views(poses, 0.05, random, {3e-3, 2e-3}));
  const Made bent = made_from(world_views(poses, 0.05, random, {3e-3, 2e-3}), true);
  EXPECT_GT(flat.calibration.excess, 10);
  EXPECT_LT(bent.calibration.excess, 2);
  EXPECT_GT(flat.calibration.sigma("fx_px").value(), 5 * bent.calibration.sigma("fx_px").value());
  for (const Made* made : {&flat, &bent}) {
    const Halves h = compare_halves(made->result(), {0.5, 1.0});
    EXPECT_TRUE(h.agree) << h.differ_px << " " << h.expected_px << " " << h.p;
  }
}

// Focal lengths from 40 sets of photographs: how many lie within 1.96 sigmas as stated and as the corners' noise alone
// has it, and in how many sets the program speaks of a bulging board.
struct FocalLengths {
  int held = 0, held_by_noise = 0, told = 0;
};
template <class Views>
FocalLengths focal_lengths(Views&& views_of) {
  FocalLengths result;
  for (std::uint64_t run = 0; run < 40; ++run) {
    Random random(run, 11);
    const Made made = made_from(views_of(world_poses(14, random), random));
    const Calibration& c = made.calibration;
    const double sigma = c.sigma("fx_px").value(), off = std::abs(c.cameras[0].lens.fx_px - world_lens().fx_px);
    result.held += off < 1.96 * sigma;
    result.held_by_noise += off < 1.96 * sigma / std::sqrt(std::max(1.0, c.excess));
    const auto bulges = [](const std::string& text) { return text.find("bulges") != std::string::npos; };
    result.told += std::ranges::any_of(c.complaints, bulges) || std::ranges::any_of(c.advice, bulges);
  }
  return result;
}

// A sheet that is bent anew in every photograph: intervals from the corners' noise alone miss the focal length, widened
// ones hold it as often as they claim.
TEST(Halves, WidenedIntervalsHoldTheFocalLengthUnderASheetBentAnewInEveryShot) {
  const FocalLengths found = focal_lengths([](const std::vector<BoardPose>& poses, Random& random) {
    std::vector<View> views;
    for (const BoardPose& pose : poses) {
      const BoardWarp bend{1e-3 * random.normal(), 1e-3 * random.normal()};
      views.push_back(world_views({pose}, 0.05, random, bend).front());
    }
    return views;
  });
  EXPECT_GE(found.held, 34) << found.held_by_noise;  // a coverage of 95 % falls below that in 0.3 % of such tests
  EXPECT_LE(found.held_by_noise, 24);
}

// A bend that all photographs share pulls all of them the same way: no scatter between them can know that, no interval
// holds the truth, and the program must say that the board bulges.
TEST(Halves, ABendThatAllShotsShareIsToldInWords) {
  const FocalLengths found = focal_lengths([](const std::vector<BoardPose>& poses, Random& random) {
    return world_views(poses, 0.05, random, {1e-3, 0.7e-3});
  });
  EXPECT_EQ(found.told, 40);
  EXPECT_LT(found.held, 40);
}

TEST(Halves, DisagreeWhereTheLensChangesBetweenThem) {
  Random random(3, 9);
  const std::vector<BoardPose> poses = world_poses(14, random);
  std::vector<View> views = world_views(poses, 0.05, random);
  for (std::size_t i = 0; i < views.size(); i += 2) {
    for (Corner& corner : views[i].corners) corner.pixel = corner.pixel * 1.004;  // refocused between shots
  }
  const Halves h = halves_of(views);
  EXPECT_FALSE(h.agree) << h.differ_px << " " << h.expected_px << " " << h.p;
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
