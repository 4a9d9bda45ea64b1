// Corners in photographs whose corners are known: no bias, the right numbers, the right layout, in every orientation.
#include <gmock/gmock.h>

#include <cmath>

#include "camera/corner_detection.h"
#include "synthetic_board.h"

namespace gonio::camera {
namespace {

constexpr int width = 640, height = 480;
constexpr double largest_rms_px = 0.03;  // sharp edges without blur, which no lens makes, are the hardest
const Intrinsics pinhole{700, 700, 319.5, 239.5, {}};

Board checkerboard() {
  return {BoardKind::checkerboard, 9, 6, 0.025, 0, "", {}};
}
Board charuco(std::optional<bool> legacy) {
  return {BoardKind::charuco, 7, 5, 0.03, 0.022, "5X5_100", legacy};
}

struct Errors {
  Vec2 mean;
  double rms = 0;
  int corners = 0;
};

Errors errors_of(const Detection& detection, const Board& board, const BoardPose& pose) {
  Errors e;
  for (const Corner& corner : detection.corners) {
    Vec2 truth;
    EXPECT_TRUE(predict(pinhole, pose, board.extent(), {}, board.corner_m(corner.id), truth));
    const Vec2 error = corner.pixel - truth;
    e.mean = e.mean + error;
    e.rms += dot(error, error);
    ++e.corners;
  }
  e.mean = e.mean * (1.0 / e.corners);
  e.rms = std::sqrt(e.rms / e.corners);
  return e;
}

const Vec3 turns[] = {{0.1, -0.05, 0.07}, {0.4, 0.2, -0.4}, {-0.3, 0.45, 1.3}};

// Mean over three views, each with about 50 corners.
void expect_unbiased(const Board& printed, const Board& sought, double distance_m) {
  Vec2 mean;
  for (const Vec3 turn : turns) {
    const BoardPose pose = pose_at(printed, turn, distance_m);
    const Detection detection = detect_board(photograph(printed, pinhole, pose, width, height, 0.005), sought, {});
    EXPECT_EQ(detection.problem, "");
    EXPECT_EQ(detection.legacy, printed.legacy.value_or(false));
    ASSERT_GT(detection.corners.size(), 0.9 * printed.corners());
    const Errors e = errors_of(detection, printed, pose);
    EXPECT_LT(e.rms, largest_rms_px);
    mean = mean + e.mean * (1.0 / 3);
  }
  EXPECT_LT(std::abs(mean.x), 0.02);
  EXPECT_LT(std::abs(mean.y), 0.02);
}

TEST(Detection, CheckerboardCornersHaveNoBias) {
  expect_unbiased(checkerboard(), checkerboard(), 0.45);
}
TEST(Detection, CharucoCornersHaveNoBias) {
  expect_unbiased(charuco(false), charuco(std::nullopt), 0.45);
}
TEST(Detection, CharucoLegacyLayoutIsFound) {
  expect_unbiased(charuco(true), charuco(std::nullopt), 0.45);
}

TEST(Detection, LayoutsAreToldApartWithAnOddNumberOfColumnsToo) {
  for (const bool legacy : {false, true}) {
    Board printed{BoardKind::charuco, 8, 5, 0.025, 0.018, "4X4_50", legacy}, sought = printed;
    sought.legacy.reset();
    const BoardPose pose = pose_at(printed, {0.2, 0.3, 0.1}, 0.45);
    const Detection detection = detect_board(photograph(printed, pinhole, pose, width, height), sought, {});
    EXPECT_EQ(detection.legacy, legacy);
    EXPECT_GT(detection.layout_votes[legacy ? 1 : 0], detection.layout_votes[legacy ? 0 : 1]);
    EXPECT_LT(errors_of(detection, printed, pose).rms, largest_rms_px);
  }
}

TEST(Detection, CheckerboardIsNumberedByItsColoursInEveryOrientation) {
  for (const double roll : {0.0, 1.6, 3.1, -1.6}) {
    const BoardPose pose = pose_at(checkerboard(), {0, 0, roll}, 0.5);
    const Detection detection =
        detect_board(photograph(checkerboard(), pinhole, pose, width, height), checkerboard(), {});
    ASSERT_EQ(detection.corners.size(), 54U) << roll;
    EXPECT_LT(errors_of(detection, checkerboard(), pose).rms, largest_rms_px) << roll;
  }
}

TEST(Detection, ReducedSearchOfALargePictureStillGivesExactCorners) {
  const Intrinsics large{2800, 2800, 1300, 950, {}};
  const BoardPose pose = pose_at(charuco(false), {0.3, -0.2, 0.2}, 0.45);
  const Detection detection =
      detect_board(photograph(charuco(false), large, pose, 2600, 1900, 0, 3), charuco(std::nullopt), {});
  ASSERT_EQ(detection.corners.size(), 35U);
  double worst = 0;
  for (const Corner& corner : detection.corners) {
    Vec2 truth;
    ASSERT_TRUE(predict(large, pose, charuco(false).extent(), {}, charuco(false).corner_m(corner.id), truth));
    worst = std::max(worst, norm(corner.pixel - truth));
  }
  EXPECT_LT(worst, 0.1);
}

TEST(Detection, HalfACharucoBoardIsEnough) {
  const BoardPose pose = pose_at(charuco(false), {0.2, 0.1, 0.1}, 0.45);
  io::Image picture = photograph(charuco(false), pinhole, pose, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 330; x < width; ++x) picture.at(x, y, 0) = 0.5F;
  }
  const Detection detection = detect_board(picture, charuco(false), {});
  EXPECT_GT(detection.corners.size(), 10U);
  EXPECT_LT(detection.corners.size(), 25U);
  EXPECT_LT(errors_of(detection, charuco(false), pose).rms, 0.05);
}

TEST(Detection, NoiseIsEstimatedWithoutALens) {
  const BoardPose pose = pose_at(checkerboard(), {0.3, 0.2, 0.1}, 0.45);
  const Detection quiet =
      detect_board(photograph(checkerboard(), pinhole, pose, width, height, 0.01), checkerboard(), {});
  const Detection loud =
      detect_board(photograph(checkerboard(), pinhole, pose, width, height, 0.1), checkerboard(), {});
  const double true_noise = errors_of(loud, checkerboard(), pose).rms / std::sqrt(2.0);
  EXPECT_GT(loud.noise_px, 2 * quiet.noise_px);
  EXPECT_GT(loud.noise_px, true_noise / 1.5);
  EXPECT_LT(loud.noise_px, true_noise * 1.5);
}

TEST(Detection, SaysWhatIsMissing) {
  const BoardPose pose = pose_at(charuco(false), {0.2, 0.1, 0.1}, 0.45);
  const io::Image picture = photograph(charuco(false), pinhole, pose, width, height);
  Board other = charuco(false);
  other.dictionary = "6X6_50";
  const Detection wrong = detect_board(picture, other, {});
  EXPECT_TRUE(wrong.corners.empty());
  EXPECT_THAT(wrong.problem, testing::HasSubstr("6X6_50"));
  const DictionaryGuess guess = guess_dictionary(picture);
  EXPECT_EQ(guess.family, "5X5_1000");
  EXPECT_EQ(guess.markers, 24);
  const Detection nothing = detect_board(io::Image(64, 48, {"Y"}), checkerboard(), {});
  EXPECT_THAT(nothing.problem, testing::HasSubstr("9 x 6"));
}

}  // namespace
}  // namespace gonio::camera
