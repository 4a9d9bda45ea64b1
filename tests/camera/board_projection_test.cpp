// The boards' forward model: its derivatives against central differences, at random lenses, poses and sags.
#include "camera/board_projection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace gonio::camera {
namespace {

struct State {
  Intrinsics lens;
  BoardPose pose;
  BoardWarp warp;
};

State random_state(Random& random) {
  State s;
  s.lens = {random.uniform(400, 900), random.uniform(400, 900), random.uniform(300, 340), random.uniform(220, 260), {}};
  for (double& d : s.lens.distortion) d = random.uniform(-0.1, 0.1);
  s.lens.distortion[LensTerm::fisheye] = random.uniform(0, 1);
  s.pose.rotation =
      quaternion_of_rotation_vector({random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(-3, 3)});
  s.pose.translation_m = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.5, 1)};
  s.warp = {random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3)};
  return s;
}

State moved_state(State s, std::size_t column, double step) {
  using C = BoardColumn;
  if (column < C::distortion) {
    double* const values[] = {&s.lens.fx_px, &s.lens.fy_px, &s.lens.cx_px, &s.lens.cy_px};
    *values[column] += step;
  } else if (column < C::rotation) {
    s.lens.distortion[column - C::distortion] += step;
  } else if (column < C::warp) {
    std::array<double, 6> change{};
    change[column - C::rotation] = step;
    s.pose = moved(s.pose, change);
  } else {
    (column == C::warp ? s.warp.sag_x_m : s.warp.sag_y_m) += step;
  }
  return s;
}

TEST(BoardProjection, DerivativesAgreeWithCentralDifferences) {
  Random random(7);
  const BoardExtent extent{{0.1, 0.06}, {0.1, 0.06}};
  for (int i = 0; i < 200; ++i) {
    const State s = random_state(random);
    const Vec2 at{random.uniform(0, 0.2), random.uniform(0, 0.12)};
    Vec2 pixel, plain;
    std::array<std::array<double, BoardColumn::count>, 2> jacobian{};
    ASSERT_TRUE(predict(s.lens, s.pose, extent, s.warp, at, pixel, jacobian));
    ASSERT_TRUE(predict(s.lens, s.pose, extent, s.warp, at, plain));
    EXPECT_LT(norm(pixel - plain), 1e-9);
    for (std::size_t c = 0; c < BoardColumn::count; ++c) {
      const double step = c < BoardColumn::distortion ? 1e-3 : 1e-5;
      Vec2 plus, minus;
      const State a = moved_state(s, c, step), b = moved_state(s, c, -step);
      ASSERT_TRUE(predict(a.lens, a.pose, extent, a.warp, at, plus));
      ASSERT_TRUE(predict(b.lens, b.pose, extent, b.warp, at, minus));
      const Vec2 slope = (plus - minus) * (0.5 / step);
      const double scale = 1 + std::abs(slope.x) + std::abs(slope.y);
      EXPECT_NEAR(jacobian[0][c], slope.x, 1e-6 * scale) << "column " << c;
      EXPECT_NEAR(jacobian[1][c], slope.y, 1e-6 * scale) << "column " << c;
    }
  }
}

TEST(BoardProjection, SagIsZeroAtTheOutermostCornersAndMovesTheMiddleAwayFromTheViewer) {
  const BoardExtent extent{{0.1, 0.06}, {0.1, 0.06}};
  const double sag[2] = {1e-3, 2e-3};
  EXPECT_EQ(board_height(extent, {0, 0}, sag), 0);
  EXPECT_EQ(board_height(extent, {0.2, 0.12}, sag), 0);
  EXPECT_DOUBLE_EQ(board_height(extent, {0.1, 0.06}, sag), 3e-3);
}

TEST(BoardProjection, NothingBehindTheCamera) {
  Vec2 pixel{1, 2};
  EXPECT_FALSE(predict({500, 500, 320, 240, {}}, {Quaternion{}, {0, 0, -1}}, {}, {}, {0, 0}, pixel));
  EXPECT_EQ(pixel, (Vec2{1, 2}));
}

}  // namespace
}  // namespace gonio::camera
