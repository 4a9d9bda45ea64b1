// Boards on paper at true scale: PDF and SVG as vectors, PNG with its resolution in the file. The board stands in the
// middle of the page, turned upright or across as it fits, with a line below it that says what it is.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "camera/board.h"

namespace gonio::camera {

struct Paper {
  std::string_view name;
  double width_mm, height_mm;  // upright; 0: as large as the board and a margin
};
const std::vector<Paper>& papers();  // a0 to a5, letter, fit
std::vector<std::string> paper_names();

struct Drawing {
  double width_mm = 0, height_mm = 0;  // of the page
  Vec2 board_mm;                       // where the squares' top-left outer corner lies, from the page's top left
  std::string caption;
};
// Error(usage) at `place` where the board does not fit on the paper with a margin of 5 mm.
Drawing lay_out(const Board& board, std::string_view paper, const std::string& place);

std::string pdf_of(const Board& board, const Drawing& drawing);
std::string svg_of(const Board& board, const Drawing& drawing);
// Grey levels are the exact share of black in each pixel, so that edges are where they belong at any resolution.
// Error(usage) at `place` above 400 million pixels.
std::string png_of(const Board& board, const Drawing& drawing, double dots_per_inch, const std::string& place);

// By extension: .pdf, .svg, .png; others are Error(usage).
void check_drawing_name(const std::filesystem::path& path);
void draw_board(const Board& board, const std::filesystem::path& path, std::string_view paper, double dots_per_inch);

}  // namespace gonio::camera
