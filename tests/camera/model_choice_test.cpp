// The choice of a lens model by held-out views, on corners whose model is known.
#include "camera/model_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "synthetic_board.h"

namespace gonio::camera {
namespace {

constexpr int width = 640, height = 480;

Board board() {
  return {BoardKind::checkerboard, 8, 6, 0.03, 0, "", {}};
}

std::vector<View> views_of(const Intrinsics& lens, const BoardWarp& warp, std::uint64_t seed, int count = 14) {
  Random random(seed);
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2 * pi * (i + random.uniform()) / count;
    const BoardPose pose =
        pose_at(board(), {0.5 * std::cos(azimuth), 0.5 * std::sin(azimuth), random.uniform(-0.5, 0.5)},
                random.uniform(0.28, 0.4), {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)});
    View view{.name = "view", .shot = static_cast<std::size_t>(i)};
    for (int id = 0; id < board().corners(); ++id) {
      Vec2 pixel;
      if (!predict(lens, pose, board().extent(), warp, board().corner_m(id), pixel)) continue;
      view.corners.push_back({id, pixel + Vec2{random.normal(), random.normal()} * 0.1, 0});
    }
    views.push_back(view);
  }
  return views;
}

ModelScore chosen(const std::vector<View>& views) {
  const CameraSetup camera{.width_px = width, .height_px = height};
  const ModelChoice choice = score_models(views, {{camera}, {{"board", board(), false, {}}}});
  EXPECT_EQ(choice.sentences.size(), choice.scores.size());
  return choice.scores[choice.chosen];
}

// One standard error lets a richer model through by chance now and then: of three seeds two must be right.
TEST(ModelChoice, APinholeStaysAPinhole) {
  int kept = 0;
  for (std::uint64_t seed = 41; seed < 44; ++seed) {
    const ModelScore own = chosen(views_of({530, 531, 322, 238, {}}, {}, seed, 8));
    kept += own.model == "pinhole" && !own.warp;
  }
  EXPECT_GE(kept, 2);
}

TEST(ModelChoice, ABentBoardAndALensAreToldApart) {
  const Intrinsics lens{530, 531, 322, 238, {-0.25, 0.06, 0.004, -0.003}};
  int right = 0;
  for (std::uint64_t seed = 51; seed < 54; ++seed) {
    const ModelScore own = chosen(views_of(lens, {}, seed, 10));
    right += own.model == "radial-tangential" && !own.warp;
  }
  EXPECT_GE(right, 2);
  const ModelScore bent = chosen(views_of(lens, {8e-4, -5e-4}, 52, 10));
  EXPECT_NE(bent.model, "pinhole");
  EXPECT_TRUE(bent.warp);
}

TEST(ModelChoice, AFisheyeIsFound) {
  Intrinsics lens{215, 216, 318, 243, {-0.03, 0.01}};
  lens.distortion[LensTerm::fisheye] = 1;
  Random random(61);
  std::vector<View> views;
  for (int i = 0; i < 10; ++i) {
    const double azimuth = 2 * pi * (i + random.uniform()) / 10;
    const BoardPose pose =
        pose_at(board(), {0.5 * std::cos(azimuth), 0.5 * std::sin(azimuth), random.uniform(-0.5, 0.5)},
                random.uniform(0.08, 0.16), {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4)});
    View view{.name = "view", .shot = static_cast<std::size_t>(i)};
    for (int id = 0; id < board().corners(); ++id) {
      Vec2 pixel;
      if (!predict(lens, pose, board().extent(), {}, board().corner_m(id), pixel)) continue;
      view.corners.push_back({id, pixel + Vec2{random.normal(), random.normal()} * 0.1, 0});
    }
    views.push_back(view);
  }
  EXPECT_EQ(chosen(views).model, "fisheye");
}

TEST(ModelChoice, FewViewsAreRefused) {
  try {
    chosen(views_of({530, 531, 322, 238, {}}, {}, 41, 5));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
  }
}

}  // namespace
}  // namespace gonio::camera
