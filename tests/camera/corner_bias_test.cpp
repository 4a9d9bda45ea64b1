// Corners of supersampled photographs against where they were put: no bias beyond 0.02 px along either axis, for plain
// boards and both ChArUco layouts, through three lenses, at three sizes of squares and blurs; and the sigma that comes
// with every corner is honest. The whole grid of cases is scripts/proofs/calib-corners.
#include <gmock/gmock.h>

#include <cmath>

#include "camera/corner_detection.h"
#include "synthetic_board.h"

namespace gonio::camera {
namespace {

constexpr int width = 420, height = 320;
constexpr double focal = 520, largest_bias_px = 0.02, largest_rms_px = 0.05;

struct Optics {
  double square_px, blur_px;
};
constexpr Optics optics[] = {{22, 0.5}, {40, 1.0}, {70, 1.5}};  // in this order through the lenses below

const Lens lenses[] = {
    {focal, focal, 209.5, 159.5},
    {focal, focal, 209.5, 159.5, -0.28},
    {focal, focal, 209.5, 159.5, -0.45, 0.1, 0.001, -0.002, 0.02, -0.02, 0.1, 0.01},
};

Board board_of(BoardKind kind, bool legacy, double square_px) {
  const int columns = square_px < 30 ? 11 : square_px < 50 ? 7 : 4;
  const int rows = square_px < 30 ? 8 : square_px < 50 ? 6 : 4;  // even: the layouts differ
  if (kind == BoardKind::checkerboard) return {kind, columns, rows - 1, 0.03, 0, "", {}};
  return {kind, columns - 1, rows - 1, 0.03, 0.022, "4X4_100", legacy};
}

struct Sums {
  Vec2 mean, square;
  double sigma2 = 0;
  int n = 0;
  void add(const Detection& detection, const Board& board, const Lens& lens, const BoardPose& pose) {
    for (const Corner& corner : detection.corners) {
      const Vec2 at = board.corner_m(corner.id);
      const Vec2 e = corner.pixel - lens.pixel(pose * Vec3{at.x, at.y, 0});
      mean = mean + e;
      square = square + Vec2{e.x * e.x, e.y * e.y};
      sigma2 += corner.sigma_px * corner.sigma_px;
      ++n;
    }
  }
};

void expect_unbiased(BoardKind kind, bool legacy) {
  double chi2 = 0, sigma2 = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t l = 0; l < 3; ++l) {
      const Board board = board_of(kind, legacy, optics[k].square_px);
      Board sought = board;
      sought.legacy.reset();
      Sums sums;
      for (const Vec3 turn : {Vec3{0.03, -0.02, 0.05}, Vec3{0.45, 0.3, -0.4}}) {
        if ((k + l) % 3 != 0 && turn.x > 0.4) continue;  // both tilts for a third of the cases
        const BoardPose pose = pose_at(board, turn, focal * board.square_m / optics[k].square_px);
        const io::Image picture = photograph(board, lenses[l], pose, width, height, {optics[k].blur_px, 0.01, 8, 7});
        const Detection detection = detect_board(picture, sought, {});
        EXPECT_GT(detection.corners.size(), 0.8 * board.corners()) << detection.problem;
        sums.add(detection, board, lenses[l], pose);
      }
      ASSERT_GT(sums.n, 0);
      const Vec2 mean = sums.mean * (1.0 / sums.n);
      const Vec2 variance{sums.square.x / sums.n - mean.x * mean.x, sums.square.y / sums.n - mean.y * mean.y};
      const auto what = testing::Message() << "square " << optics[k].square_px << " px, lens " << l << ", " << sums.n
                                           << " corners: mean " << mean.x << " " << mean.y << " +- "
                                           << std::sqrt(variance.x / sums.n) << " " << std::sqrt(variance.y / sums.n);
      EXPECT_LT(std::abs(mean.x), largest_bias_px) << what;
      EXPECT_LT(std::abs(mean.y), largest_bias_px) << what;
      EXPECT_LT(std::sqrt((sums.square.x + sums.square.y) / (2 * sums.n)), largest_rms_px) << what;
      chi2 += 0.5 * (sums.square.x + sums.square.y);
      sigma2 += sums.sigma2;
    }
  }
  EXPECT_LT(chi2, 1.5 * 1.5 * sigma2) << "sigmas are too small";
  EXPECT_GT(chi2, sigma2 / (2 * 2)) << "sigmas are too large";
}

TEST(CornerBias, Checkerboard) {
  expect_unbiased(BoardKind::checkerboard, false);
}
TEST(CornerBias, CharucoInTheCurrentLayout) {
  expect_unbiased(BoardKind::charuco, false);
}
TEST(CornerBias, CharucoInTheLegacyLayout) {
  expect_unbiased(BoardKind::charuco, true);
}

// A grid of corners on a white sheet of which a part is covered: what is left is as exact, and nothing else is
// invented.
TEST(CornerBias, CoveredCornersAreLeftOut) {
  const Board board = board_of(BoardKind::charuco, false, 22);
  const BoardPose pose = pose_at(board, {0.1, 0.2, 0.3}, focal * board.square_m / 24);
  io::Image picture = photograph(board, lenses[1], pose, width, height, {0.8, 0.01, 8, 3});
  for (int y = 0; y < height; ++y) {
    for (int x = 200; x < 240; ++x) picture.at(x, y, 0) = 0.3F;  // a cable across the board
  }
  Sums sums;
  sums.add(detect_board(picture, board, {}), board, lenses[1], pose);
  EXPECT_GT(sums.n, 30);
  EXPECT_LT(std::sqrt((sums.square.x + sums.square.y) / (2 * sums.n)), largest_rms_px);
}

struct HardView {
  const char* what;
  Vec3 turn;
  double square_px, blur_px, most_rms_px;
};

// What edges say is read wherever they are: along the long sides of squares that a tilt has made three times as long as
// high, and across the whole width of edges that are out of focus. With one reach for both sides, and a band of 4.5 px
// at most across, the errors were 0.0104 and 0.041 px.
TEST(CornerBias, TiltedAndDefocusedCornersAreReadAsFarAsTheirEdgesGo) {
  const Lens lens{700, 700, 239.5, 179.5};
  for (const HardView& view : {HardView{"tilted", {-0.404, 1.183, 0.3}, 56, 0.6, 0.0086},
                               HardView{"out of focus", {-0.065, 0.189, 0.3}, 40, 4, 0.022}}) {
    const Board board{BoardKind::checkerboard, 6, 5, 0.03, 0, "", {}};
    Sums sums;
    for (const std::uint64_t seed : {5U, 6U}) {
      const BoardPose pose = pose_at(board, view.turn, 1.2 * lens.fx * board.square_m / view.square_px);
      sums.add(detect_board(photograph(board, lens, pose, 480, 360, {view.blur_px, 0.01, 4, seed}), board, {}), board,
               lens, pose);
    }
    EXPECT_GE(sums.n, 58) << view.what;
    EXPECT_LT(std::sqrt((sums.square.x + sums.square.y) / (2 * sums.n)), view.most_rms_px) << view.what;
  }
}

}  // namespace
}  // namespace gonio::camera
