// Check views: how far a camera has moved is known as closely as is said, and nothing is reported where nothing moved.
#include "acquisition/run/board_shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "base/error.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

constexpr double corner_px = 0.05;

camera::Board board() {
  camera::Board b;
  b.kind = camera::BoardKind::checkerboard;
  b.corner_columns = 8, b.corner_rows = 6, b.square_m = 0.02;
  return b;
}
camera::Intrinsics lens() {
  return {.fx_px = 720, .fy_px = 718, .cx_px = 322, .cy_px = 238, .distortion = {}};
}

// A camera 0.35 m before the board, tilted; moved in the board's frame by `by` and turned by `turn`.
camera::BoardPose camera_moved(Vec3 by, Vec3 turn) {
  camera::BoardPose pose;
  pose.rotation = quaternion_of_rotation_vector({0.3, -0.2, 0.5});
  pose.translation_m = {-0.05, -0.04, 0.35};
  auto board_from_camera = inverse(pose);
  board_from_camera.translation_m = board_from_camera.translation_m + by;
  board_from_camera.rotation = normalized(quaternion_of_rotation_vector(turn) * board_from_camera.rotation);
  return inverse(board_from_camera);
}

// What a detector finds: a bias that belongs to the corner, and noise; it states the noise `stated`.
std::vector<camera::Corner> corners_seen(const camera::BoardPose& pose, Random& random, double stated = corner_px) {
  std::vector<camera::Corner> corners;
  Random own(4);
  const camera::Board b = board();
  for (int id = 0; id < b.corners(); ++id) {
    Vec2 pixel;
    if (!camera::predict(lens(), pose, b.extent(), {}, b.corner_m(id), pixel)) continue;
    const Vec2 bias{0.3 * own.normal(),
                    0.3 * own.normal()};  // six times the noise: a lens that is not the one believed
    corners.push_back({id, pixel + bias + Vec2{random.normal(), random.normal()} * corner_px, stated});
  }
  return corners;
}

int rounds(int otherwise) {
  const char* text = std::getenv("GONIO_ROUNDS");
  return text == nullptr ? otherwise : std::atoi(text);
}

TEST(BoardShift, AMotionIsFoundThroughALensThatIsNotTheOneBelieved) {
  Random random(3);
  const Vec3 by{0.0004, -0.0007, 0.0005}, turn{0.001, 0.002, -0.0015};
  const auto shift = shift_between(corners_seen(camera_moved({}, {}), random),
                                   corners_seen(camera_moved(by, turn), random), board(), lens());
  ASSERT_TRUE(shift && shift->position_m);
  const Vec3 middle{board().extent().middle_m.x, board().extent().middle_m.y, 0};
  const Vec3 moved = camera_moved(by, turn) * middle - camera_moved({}, {}) * middle;
  const Vec3 turned = rotation_vector_of(camera_moved(by, turn).rotation * conjugate(camera_moved({}, {}).rotation));
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(shift->position_m->by[k], moved[k], 4 * std::sqrt(shift->position_m->covariance(k, k)));
    EXPECT_NEAR(shift->rotation_rad->by[k], turned[k], 4 * std::sqrt(shift->rotation_rad->covariance(k, k)));
  }
  EXPECT_LT(std::sqrt(shift->position_m->covariance(0, 0)), 3e-5);
}

// (d - truth)' C^-1 (d - truth) is chi-square of three: mean 3, standard deviation sqrt(6); of 300 within 0.45.
TEST(BoardShift, ItsCovarianceIsWhatNoiseDoes) {
  Random random(11);
  const int n = rounds(150);
  for (const double stated : {corner_px, 0.5 * corner_px}) {  // understated noise shows in the residuals
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const Vec3 by{1e-4 * random.normal(), 1e-4 * random.normal(), 1e-4 * random.normal()};
      const auto shift = shift_between(corners_seen(camera_moved({}, {}), random, stated),
                                       corners_seen(camera_moved(by, {}), random, stated), board(), lens());
      // With a limit of almost nothing the statistic is that of the change itself.
      BoardShift off = *shift;
      off.position_m->by =
          off.position_m->by - (camera_moved(by, {}).translation_m - camera_moved({}, {}).translation_m);
      sum += judge_drift(off, {1e-12, DriftUnit::metres}, 0.05).beyond;
    }
    // 5 % of the rounds, and no more than three of their standard deviations off.
    EXPECT_NEAR(sum / n, 0.05, 3 * std::sqrt(0.05 * 0.95 / n)) << stated;
  }
}

// At the limit itself the chance is at most the level; within it, less.
TEST(BoardShift, WhatStaysWithinTheLimitIsNotReported) {
  Random random(17);
  const int n = rounds(150);
  int at_limit = 0, beyond = 0;
  const double limit = 3e-4;
  for (int i = 0; i < n; ++i) {
    const Vec3 way = normalized(Vec3{random.normal(), random.normal(), random.normal()});
    const auto before = corners_seen(camera_moved({}, {}), random);
    const auto judged = [&](double length) {
      return judge_drift(*shift_between(before, corners_seen(camera_moved(way * length, {}), random), board(), lens()),
                         {limit, DriftUnit::metres}, 0.01);
    };
    at_limit += judged(limit).beyond;
    beyond += judged(2e-3).beyond;
  }
  EXPECT_LE(at_limit, 0.01 * n + 3 * std::sqrt(0.01 * n));
  EXPECT_EQ(beyond, n);
}

TEST(BoardShift, AFingerBeforeTheBoardMovesNothing) {
  Random random(5);
  auto now = corners_seen(camera_moved({}, {}), random);
  for (int k = 0; k < 4; ++k)
    now[static_cast<std::size_t>(k)].pixel = now[static_cast<std::size_t>(k)].pixel + Vec2{9, -4};
  const auto shift = shift_between(corners_seen(camera_moved({}, {}), random), now, board(), lens());
  EXPECT_FALSE(judge_drift(*shift, {1e-6, DriftUnit::metres}, 1e-4).beyond);
  now.resize(least_check_corners - 1);
  EXPECT_FALSE(shift_between(corners_seen(camera_moved({}, {}), random), now, board(), lens()));
}

TEST(BoardShift, WithoutALensThePictureStillTells) {
  Random random(7);
  const auto shift = shift_between(corners_seen(camera_moved({}, {}), random),
                                   corners_seen(camera_moved({0.001, 0, 0}, {}), random), board(), std::nullopt);
  ASSERT_TRUE(shift);
  EXPECT_FALSE(shift->position_m);
  EXPECT_TRUE(judge_drift(*shift, {1, DriftUnit::pixels}, 0.001).beyond);  // 1 mm at 0.35 m: 2 px
  EXPECT_FALSE(judge_drift(*shift, {2.2, DriftUnit::pixels}, 0.001).beyond);
  EXPECT_THROW(judge_drift(*shift, {0.001, DriftUnit::metres}, 0.001), Error);
}

TEST(BoardShift, LimitsAreTypedWithTheirUnits) {
  EXPECT_DOUBLE_EQ(parse_drift_limit("0.3mm", "--drift-limit").value, 3e-4);
  EXPECT_EQ(parse_drift_limit("0.1deg", "--drift-limit").unit, DriftUnit::radians);
  EXPECT_EQ(parse_drift_limit("0.5px", "--drift-limit").unit, DriftUnit::pixels);
  for (const char* wrong : {"0.3", "3kg", "-1mm", "0mm", ""})
    EXPECT_THROW(parse_drift_limit(wrong, "--drift-limit"), Error);
}

// Stated at 95 %: over rounds of four takes of two views each, the interval holds the truth that often, also of an arm
// that comes back exactly.
TEST(Scatter, ItsIntervalHoldsTheTruth) {
  Random random(23);
  const int n = rounds(400);
  for (const double truth : {0.0, 5e-5, 3e-4}) {
    int held = 0;
    for (int i = 0; i < n; ++i) {
      std::vector<std::vector<Moved>> views(2);
      for (std::size_t v = 0; v < 2; ++v)
        for (int k = 0; k < 4; ++k) {
          const Vec3 sigma{1e-4, 6e-5, 2e-5};  // of the corners, by direction
          Moved m{{}, {{1e-8, 0, 0, 0, 3.6e-9, 0, 0, 0, 4e-10}}};
          m.by = {0.01 + std::hypot(truth, sigma.x) * random.normal(), std::hypot(truth, sigma.y) * random.normal(),
                  std::hypot(truth, sigma.z) * random.normal()};
          views[v].push_back(m);
        }
      const auto scatter = scatter_of(views);
      held += scatter->lower <= truth && truth <= scatter->upper;
      EXPECT_LE(scatter->lower, scatter->sigma);
      EXPECT_LE(scatter->sigma, scatter->upper);
    }
    const double share = static_cast<double>(held) / n;
    EXPECT_GE(share, 0.95 - 3 * std::sqrt(0.05 * 0.95 / n)) << truth;
    if (truth > 0) {
      EXPECT_LE(share, 0.95 + 3 * std::sqrt(0.05 * 0.95 / n)) << truth;
    }
  }
  EXPECT_FALSE(scatter_of(std::vector<std::vector<Moved>>{{{{}, {}}}}));
}

}  // namespace
}  // namespace gonio::acquisition
