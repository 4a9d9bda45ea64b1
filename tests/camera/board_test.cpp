// Boards: geometry, layouts, what is refused; drawings at true scale that the detector reads back.
#include "camera/board.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "base/atomic_file.h"
#include "base/error.h"
#include "camera/board_drawing.h"
#include "camera/corner_detection.h"
#include "camera/marker_dictionary.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/sections/board.h"

namespace gonio::camera {
namespace {

Board charuco(int columns, int rows, std::optional<bool> legacy) {
  return {BoardKind::charuco, columns - 1, rows - 1, 0.02, 0.015, "4X4_100", legacy};
}

double area(const std::vector<Rectangle>& list) {
  double sum = 0;
  for (const Rectangle& r : list) sum += (r.high_m.x - r.low_m.x) * (r.high_m.y - r.low_m.y);
  return sum;
}

TEST(Board, CornersAndExtent) {
  const Board plain{BoardKind::checkerboard, 9, 6, 0.025, 0, "", {}};
  EXPECT_EQ(plain.corner_m(0), (Vec2{0, 0}));
  EXPECT_EQ(plain.corner_m(10), (Vec2{0.025, 0.025}));
  EXPECT_NEAR(plain.extent().half_m.x, 0.1, 1e-15);
  EXPECT_NEAR(area(black_areas(plain)), 35 * 0.025 * 0.025, 1e-12);
  const Board marked = charuco(7, 5, {});
  EXPECT_EQ(marked.corner_m(0), (Vec2{0.02, 0.02}));
  EXPECT_EQ(markers(marked).size(), 17U);
}

TEST(Board, LayoutsDifferOnlyWhereTheRowsAreEven) {
  // Odd rows: the first marker is right of the black top-left square, whatever the layout.
  EXPECT_NEAR(markers(charuco(7, 5, true))[0].corners_m[0].x, 0.0225, 1e-15);
  EXPECT_NEAR(markers(charuco(7, 6, false))[0].corners_m[0].x, 0.0225, 1e-15);
  EXPECT_NEAR(markers(charuco(7, 6, true))[0].corners_m[0].x, 0.0025, 1e-15);
  EXPECT_EQ(markers(charuco(25, 18, true)).size(), 225U);
}

TEST(Dictionary, NamesAsPeopleWriteThem) {
  EXPECT_EQ(dictionary_name("DICT_5X5_1000", "t"), "5X5_1000");
  EXPECT_EQ(dictionary_name("4x4_50", "t"), "4X4_50");
  EXPECT_THROW(dictionary_name("9X9_50", "t"), Error);
  EXPECT_EQ(dictionary_size("4X4_50"), 50);
  const MarkerCells cells = marker_cells("6X6_250", 3);
  EXPECT_EQ(cells.side, 8);
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(cells.black[static_cast<std::size_t>(i)]);  // the border
}

void expect_refused(const manifest::Board& section, const std::string& place) {
  try {
    board_of(section, "t#/boards/b");
    FAIL() << "accepted; expected an error at " << place;
  } catch (const Error& e) {
    EXPECT_EQ(e.place(), "t#/boards/b" + place);
  }
}

TEST(Board, RefusesWhatIsNoBoard) {
  const manifest::Board good = section_of(charuco(7, 6, true));
  EXPECT_TRUE(board_of(good, "t").legacy.value());
  manifest::Board b = good;
  b.square_m = -0.02;
  expect_refused(b, "/square_m");
  b = good;
  b.marker_m = 0.03;
  expect_refused(b, "/marker_m");
  b = good;
  b.dictionary = "";
  expect_refused(b, "/dictionary");
  b.dictionary = "4X4_50";
  b.squares = {25, 18};
  expect_refused(b, "/dictionary");  // needs 225 markers
  b = good;
  b.squares = {7};
  expect_refused(b, "/squares");
  b.kind = "dots";
  expect_refused(b, "/kind");
}

// poppler places edges on a grid of a quarter pixel.
constexpr double poppler_px = 0.3;

// Corners of a drawing at `dpi`: where they must lie, in pixels, and where they are found.
void expect_drawn(const io::Image& picture, const Board& board, double dpi, double tolerance_px) {
  Board sought = board;
  sought.legacy.reset();
  const Detection detection = detect_board(picture, sought, {});
  ASSERT_EQ(detection.corners.size(), static_cast<std::size_t>(board.corners()));
  EXPECT_EQ(detection.legacy, board.layout_matters() && board.legacy.value_or(false));
  const Drawing drawing = lay_out(board, "a4", "t");
  for (const Corner& corner : detection.corners) {
    const Vec2 at_mm = drawing.board_mm + (board.corner_m(corner.id) - board.squares_origin_m()) * 1e3;
    EXPECT_LT(norm(corner.pixel - (at_mm * (dpi / 25.4) - Vec2{0.5, 0.5})), tolerance_px) << corner.id;
  }
}

const Board boards[] = {{BoardKind::checkerboard, 9, 6, 0.02, 0, "", {}},
                        {BoardKind::charuco, 6, 4, 0.025, 0.018, "4X4_100", {}},
                        {BoardKind::charuco, 6, 5, 0.025, 0.018, "4X4_100", false},
                        {BoardKind::charuco, 6, 5, 0.025, 0.018, "4X4_100", true},
                        {BoardKind::charuco, 7, 5, 0.025, 0.018, "5X5_100", true}};

TEST(Drawing, PngHasItsCornersWhereThePaperHasThem) {
  const tests::ScratchFolder folder;
  for (const Board& board : boards) {
    draw_board(board, folder / "b.png", "a4", 110);
    const io::Image picture = io::read_picture(folder / "b.png");
    EXPECT_EQ(picture.width, 1286);  // 297 mm
    expect_drawn(picture, board, 110, 0.15);
  }
  EXPECT_EQ(read_file(folder / "b.png").substr(37, 4), "pHYs");
}

TEST(Drawing, PdfRasterisedByAnotherProgramIsTheSameBoard) {
  if (std::system("command -v pdftoppm >/dev/null") != 0) GTEST_SKIP() << "pdftoppm is missing";
  const tests::ScratchFolder folder;
  for (const Board& board : boards) {
    draw_board(board, folder / "b.pdf", "a4", 0);
    const std::string stem = (folder / "page").string();
    ASSERT_EQ(
        std::system(("pdftoppm -r 110 -gray -singlefile -png " + (folder / "b.pdf").string() + " " + stem).c_str()), 0);
    expect_drawn(io::read_picture(stem + ".png"), board, 110, poppler_px);
  }
}

TEST(Drawing, SvgStatesMillimetres) {
  const Drawing drawing = lay_out(boards[1], "a4", "t");
  const std::string svg = svg_of(boards[1], drawing);
  EXPECT_THAT(
      svg, testing::HasSubstr("width=\"297.000000mm\" height=\"210.000000mm\" viewBox=\"0 0 297.000000 210.000000\""));
  EXPECT_THAT(svg, testing::HasSubstr("charuco 7x5 squares, square 25 mm, marker 18 mm, 4X4_100; print at 100 %"));
  EXPECT_NO_THROW(lay_out(boards[1], "a5", "t"));
  EXPECT_THROW(lay_out(boards[1], "a6", "t"), Error);
  Board large = boards[1];
  large.square_m = 0.03;  // 210 mm, which leaves no margin on 210 mm
  EXPECT_THROW(lay_out(large, "a5", "t"), Error);
  EXPECT_THROW(check_drawing_name("b.gif"), Error);
}

}  // namespace
}  // namespace gonio::camera
