// The joint refinement against simulated truth: exact where nothing is noisy, better than the closed forms where both
// robot and camera are, and with standard deviations that hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "robot/handeye/closed_forms.h"
#include "robot/handeye/refinement.h"
#include "robot/handeye_world.h"

namespace gonio::robot::handeye {
namespace {

using tests::HandEyeWorld;

Refined refined(const HandEyeWorld& world, const std::vector<View>& views) {
  const Setup setup = world.setup();
  return refine(setup, views, std::vector<bool>(views.size(), true),
                closed_form("park", "").solve(samples_of(setup, views)));
}

std::vector<double> errors(const Solution& found, const Solution& truth) {
  std::vector<double> e = tests::error_of(found.mount_from_camera, truth.mount_from_camera);
  const auto z = tests::error_of(found.stand_from_board, truth.stand_from_board);
  e.insert(e.end(), z.begin(), z.end());
  return e;
}

TEST(Refinement, IsExactOnExactData) {
  for (const auto kind : {Kind::eye_in_hand, Kind::eye_to_hand}) {
    HandEyeWorld world;
    world.kind = kind;
    world.corner_px = world.robot_m = world.robot_rad = 0;
    const Refined r = refined(world, world.views(1));
    for (const double e : errors(r.solution, world.truth)) EXPECT_LT(std::abs(e), 1e-8);
  }
}

TEST(Refinement, EstimatesBothNoises) {
  HandEyeWorld world;
  world.poses = 60;
  world.corner_px = 0.2;  // the detector claims 0.1
  for (const double robot : {1.0, 0.2}) {
    world.robot_m = 0.0005 * robot;
    world.robot_rad = 0.001 * robot;
    const Refined r = refined(world, world.views(2));
    EXPECT_TRUE(r.converged);
    EXPECT_NEAR(r.noise.corner, 2, 0.1);
    EXPECT_NEAR(r.noise.robot_m / world.robot_m, 1, robot == 1 ? 0.2 : 0.5);
    EXPECT_NEAR(r.noise.robot_rad / world.robot_rad, 1, robot == 1 ? 0.2 : 0.5);
  }
}

// 50 runs here, 500 in scripts/proofs/handeye-coverage: intervals of 95 % over all twelve parameters.
TEST(Refinement, IntervalsCoverTheTruth) {
  for (const auto kind : {Kind::eye_in_hand, Kind::eye_to_hand}) {
    HandEyeWorld world;
    world.kind = kind;
    int covered = 0, all = 0;
    double joint = 0, closed = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const auto views = world.views(100 + seed);
      const Refined r = refined(world, views);
      const auto e = errors(r.solution, world.truth);
      for (std::size_t k = 0; k < 12; ++k) covered += std::abs(e[k]) <= 1.96 * r.sigma(k);
      all += 12;
      joint +=
          std::pow(norm(r.solution.mount_from_camera.translation_m - world.truth.mount_from_camera.translation_m), 2);
      const Solution park = closed_form("park", "").solve(samples_of(world.setup(), views));
      closed += std::pow(norm(park.mount_from_camera.translation_m - world.truth.mount_from_camera.translation_m), 2);
    }
    const double share = static_cast<double>(covered) / all;
    std::cout << "covered " << share << ", joint " << std::sqrt(joint / 50) << " m, park " << std::sqrt(closed / 50)
              << " m\n";
    EXPECT_GT(share, 0.91);
    EXPECT_LT(share, 0.985);
    EXPECT_LT(joint, closed);
  }
}

TEST(Refinement, DoesNotDependOnTheOrderOfViews) {
  HandEyeWorld world;
  auto views = world.views(3);
  const Refined first = refined(world, views);
  std::ranges::reverse(views);
  std::swap(views[2], views[9]);
  const Refined second = refined(world, views);
  for (const double e : errors(second.solution, first.solution)) EXPECT_LT(std::abs(e), 1e-9);
}

}  // namespace
}  // namespace gonio::robot::handeye
