// Boards of which a photograph shows a part, several boards in one photograph, and dictionaries of one's own.
#include <gmock/gmock.h>

#include <cmath>

#include "base/error.h"
#include "camera/board_drawing.h"
#include "camera/corner_detection.h"
#include "camera/marker_dictionary.h"
#include "synthetic_board.h"

namespace gonio::camera {
namespace {

constexpr int width = 480, height = 360;
const Lens lens{560, 560, 239.5, 179.5, -0.2, 0.05};

Board charuco(const char* dictionary = "5X5_100") {
  return {BoardKind::charuco, 9, 6, 0.02, 0.015, dictionary, {}};
}

double rms_error(const Detection& detection, const Board& board, const BoardPose& pose) {
  double sum = 0;
  for (const Corner& corner : detection.corners) {
    const Vec2 at = board.corner_m(corner.id);
    const Vec2 e = corner.pixel - lens.pixel(pose * Vec3{at.x, at.y, 0});
    sum += 0.5 * dot(e, e);
  }
  return std::sqrt(sum / static_cast<double>(detection.corners.size()));
}

// Corners that lie at least `margin` inside the picture.
int corners_inside(const Board& board, const BoardPose& pose, double margin) {
  int n = 0;
  for (int id = 0; id < board.corners(); ++id) {
    const Vec2 at = board.corner_m(id), p = lens.pixel(pose * Vec3{at.x, at.y, 0});
    n += p.x > margin && p.y > margin && p.x < width - 1 - margin && p.y < height - 1 - margin ? 1 : 0;
  }
  return n;
}

TEST(PartialBoards, WhatABorderLeavesOfACharucoBoardIsFoundAndExact) {
  const Board board = charuco();
  for (const Vec2 shift : {Vec2{1.2, 0.3}, Vec2{-1.0, 0.9}, Vec2{0.3, -1.3}}) {
    const BoardPose pose = pose_at(board, {0.25, -0.2, 0.3}, 0.27, shift);
    const int inside = corners_inside(board, pose, 14), near = corners_inside(board, pose, 2);
    ASSERT_GT(inside, 0.2 * board.corners());
    ASSERT_LT(near, 0.75 * board.corners());
    const Detection detection =
        detect_board(photograph(board, lens, pose, width, height, {0.7, 0.01, 8, 5}), board, {});
    EXPECT_GE(static_cast<int>(detection.corners.size()), 0.9 * inside);
    EXPECT_LE(static_cast<int>(detection.corners.size()), near);
    EXPECT_LT(rms_error(detection, board, pose), 0.04);
  }
}

// Seen in part where that is asked for: exact up to a shift by whole squares, which the board's pose takes up.
TEST(PartialBoards, WhatABorderLeavesOfAPlainBoardIsExactUpToWholeSquares) {
  const Board board{BoardKind::checkerboard, 9, 6, 0.02, 0, "", {}};
  DetectionOptions parts;
  parts.parts = true;
  for (const Vec2 shift : {Vec2{0.8, 0}, Vec2{-0.9, 0.3}, Vec2{0.2, -0.8}}) {
    const BoardPose pose = pose_at(board, {0.25, -0.2, 0.15}, 0.25, shift);
    const int inside = corners_inside(board, pose, 14), near = corners_inside(board, pose, 2);
    ASSERT_GT(inside, 0.4 * board.corners());
    ASSERT_LT(near, board.corners());
    const Detection found = detect_board(photograph(board, lens, pose, width, height, {0.7, 0.01, 4, 5}), board, parts);
    EXPECT_TRUE(found.part);
    EXPECT_GE(static_cast<int>(found.corners.size()), 0.9 * inside);
    EXPECT_LE(static_cast<int>(found.corners.size()), near);
    double best = 1e9;
    for (int columns = -8; columns <= 8; ++columns)
      for (int rows = -5; rows <= 5; ++rows) {
        BoardPose shifted = pose;
        shifted.translation_m = pose * Vec3{columns * board.square_m, rows * board.square_m, 0};
        best = std::min(best, rms_error(found, board, shifted));
      }
    EXPECT_LT(best, 0.04);
    // The side that is missing lies outside: the place that leaves least unseen is the true one.
    EXPECT_LT(rms_error(found, board, pose), 0.04) << shift.x << " " << shift.y;
  }
}

// Where the whole is in the picture, asking for parts changes nothing; where nothing of a board is, nothing is found.
TEST(PartialBoards, AskingForPartsChangesNothingElsewhere) {
  const Board board{BoardKind::checkerboard, 9, 6, 0.02, 0, "", {}};
  DetectionOptions parts;
  parts.parts = true;
  const io::Image whole =
      photograph(board, lens, pose_at(board, {0.2, 0.1, 0.1}, 0.42), width, height, {0.7, 0.01, 4, 5});
  const Detection a = detect_board(whole, board, {}), b = detect_board(whole, board, parts);
  ASSERT_EQ(a.corners.size(), 54U);
  EXPECT_FALSE(b.part);
  ASSERT_EQ(b.corners.size(), a.corners.size());
  for (std::size_t i = 0; i < a.corners.size(); ++i) EXPECT_EQ(a.corners[i].pixel, b.corners[i].pixel);
  EXPECT_TRUE(detect_board(io::Image(width, height, {"Y"}), board, parts).corners.empty());
}

TEST(PartialBoards, APlainBoardMustBeSeenWholeWherePartsAreNotAskedFor) {
  const Board plain{BoardKind::checkerboard, 9, 6, 0.02, 0, "", {}};
  const BoardPose pose = pose_at(plain, {0.2, 0.1, 0.1}, 0.25, {0.8, 0});
  const Detection detection = detect_board(photograph(plain, lens, pose, width, height, {0.7, 0.01, 4, 5}), plain, {});
  EXPECT_TRUE(detection.corners.empty());
  EXPECT_THAT(detection.problem, testing::HasSubstr("whole"));
}

// A plain board that is mirrored looks like one that is not whenever half a turn or a quarter turn makes up for it.
// With an odd number of squares one way and an even number the other, its colours say which corner is the first, but a
// mirror image is the same board seen turned over: nothing in it tells. Markers do.
TEST(PartialBoards, AMirroredCharucoBoardIsNotFound) {
  const Board board = charuco();
  const BoardPose pose = pose_at(board, {0.25, -0.2, 0.3}, 0.42);
  const io::Image seen = photograph(board, lens, pose, width, height, {0.7, 0.01, 4, 5});
  io::Image mirrored = seen;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) mirrored.at(x, y, 0) = seen.at(width - 1 - x, y, 0);
  }
  EXPECT_EQ(detect_board(seen, board, {}).corners.size(), 54U);
  EXPECT_TRUE(detect_board(mirrored, board, {}).corners.empty());
}

TEST(PartialBoards, TwoBoardsInOnePictureKeepTheirOwnCorners) {
  const Board first{BoardKind::charuco, 4, 4, 0.02, 0.015, "5X5_100", {}};
  const Board second{BoardKind::charuco, 4, 4, 0.02, 0.015, "4X4_100", {}};
  const BoardPose left = pose_at(first, {0.2, 0.2, 0.1}, 0.33, {-1.6, 0}),
                  right = pose_at(second, {-0.2, 0.3, 0}, 0.33, {1.6, 0});
  const Exposure exposure{0.7, 0.01, 8, 5};
  const io::Image a = photograph(first, lens, left, width, height, exposure);
  const io::Image b = photograph(second, lens, right, width, height, exposure);
  io::Image both = a;
  for (int y = 0; y < height; ++y) {
    for (int x = width / 2; x < width; ++x) both.at(x, y, 0) = b.at(x, y, 0);
  }
  for (const auto& [board, pose] : {std::pair(first, left), std::pair(second, right)}) {
    const Detection detection = detect_board(both, board, {});
    EXPECT_EQ(detection.corners.size(), 16U) << board.dictionary;
    EXPECT_LT(rms_error(detection, board, pose), 0.04);
  }
}

// Twelve markers of 4 x 4 cells, taken from OpenCV's fourth family so that their distances are fair.
std::string dictionary_text(const char* opening, const char* line, const char* closing, int first, int count) {
  std::string text = opening;
  for (int i = 0; i < count; ++i) {
    const MarkerCells cells = marker_cells("4X4_1000", first + i);
    std::string bits;
    for (int y = 1; y < 5; ++y) {
      for (int x = 1; x < 5; ++x) bits += cells.black[static_cast<std::size_t>(y * 6 + x)] ? '0' : '1';
    }
    char entry[100];
    std::snprintf(entry, sizeof entry, line, i, bits.c_str());
    text += entry;
  }
  return text + closing;
}
std::string yaml(int first, int count) {
  return dictionary_text(("%YAML:1.0\n---\nnmarkers: " + std::to_string(count) + "\nmarkersize: 4\n").c_str(),
                         "marker_%d: \"%s\"\n", "", first, count);
}

TEST(OwnDictionary, YamlAndJsonSayTheSame) {
  const OwnDictionary a = parse_dictionary(yaml(3, 12), "a", "t");
  const OwnDictionary b =
      parse_dictionary(dictionary_text("{\"nmarkers\": 12, \"markersize\": 4, ", "\"marker_%d\": \"%s\", ",
                                       "\"maxCorrectionBits\": 0}", 3, 12),
                       "b", "t");
  EXPECT_EQ(a.white, b.white);
  EXPECT_EQ(a.white.size(), 12U);
  EXPECT_GE(a.distance, 3);
  EXPECT_EQ(a.correctable, (a.distance - 1) / 2);
  EXPECT_EQ(b.correctable, 0);
  EXPECT_EQ(marker_cells(a, 5).black, marker_cells("4X4_1000", 8).black);
}

TEST(OwnDictionary, WhatMakesNoDictionaryIsRefused) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parse_dictionary(text, "d", "t");
    } catch (const Error& e) {
      return e.problem();
    }
    return "accepted";
  };
  const std::string head = "nmarkers: 2\nmarkersize: 3\n";
  EXPECT_EQ(refusal(head + "marker_0: 110000010\nmarker_1: 101010010\n"), "accepted");
  EXPECT_THAT(refusal(""), testing::HasSubstr("nmarkers"));
  EXPECT_THAT(refusal("nmarkers: 2\nmarkersize: 77\n"), testing::HasSubstr("markersize is 77"));
  EXPECT_THAT(refusal(head + "marker_0: 110000010\n"), testing::HasSubstr("no \"marker_1\""));
  EXPECT_THAT(refusal(head + "marker_0: 1100000101\nmarker_1: 101010010\n"), testing::HasSubstr("not 9 digits"));
  EXPECT_THAT(refusal(head + "marker_0: 110000012\nmarker_1: 101010010\n"), testing::HasSubstr("not 9 digits"));
  EXPECT_THAT(refusal(head + "marker_0: 110000010\nmarker_1: 110000010\n"), testing::HasSubstr("are the same"));
  EXPECT_THAT(refusal(head + "marker_0: 110000010\nmarker_1: 001101000\n"), testing::HasSubstr("but for a turn"));
  EXPECT_THAT(refusal(head + "marker_0: 010101010\nmarker_1: 101010010\n"),
              testing::HasSubstr("looks the same when turned"));
}

TEST(OwnDictionary, ABoardWithItIsDrawnAndFoundAndOthersAreNot) {
  Board board{BoardKind::charuco, 5, 3, 0.025, 0.018, "mine.yml", {}, nullptr};
  board.own_dictionary = std::make_shared<const OwnDictionary>(parse_dictionary(yaml(400, 12), "mine.yml", "t"));
  const BoardPose pose = pose_at(board, {0.3, 0.2, 0.1}, 0.3);
  const io::Image picture = photograph(board, lens, pose, width, height, {0.7, 0.01, 8, 5});
  const Detection detection = detect_board(picture, board, {});
  EXPECT_EQ(detection.markers, 12);
  EXPECT_EQ(detection.corners.size(), 15U);
  EXPECT_LT(rms_error(detection, board, pose), 0.04);
  Board other = board;
  other.own_dictionary = std::make_shared<const OwnDictionary>(parse_dictionary(yaml(500, 12), "mine.yml", "t"));
  EXPECT_TRUE(detect_board(picture, other, {}).corners.empty());
  EXPECT_THAT(svg_of(board, lay_out(board, "a4", "t")), testing::HasSubstr("mine.yml"));
}

}  // namespace
}  // namespace gonio::camera
