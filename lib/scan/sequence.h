// What a projector shows in turn, so that cameras can tell which of its pixels lit them.
//
// Pixel (column, row) of the projector has its centre at (column, row), as cameras have. A Gray code shows the bits of
// column ^ (column >> 1), the coarsest first, each followed by its inverse: neighbours differ in one bit, and what lies
// between a pattern and its inverse needs no threshold (Inokuchi, Sato & Matsuda 1984). Cosines show
//   light = (1 + cos(theta - shift)) / 2,   theta = 2 pi periods (u + 1/2) / size,   u the column or row
// at several shifts for each number of periods: three unknowns of a pixel, its light from elsewhere, what it sends back
// and theta, need three shifts at least (Srinivasan, Liu & Halioua 1984). Lines one pixel wide, period_px apart, shown
// at all offsets in turn, tell where within a period a pixel is lit, and a coarse Gray code which period it is
// (Guehring 2001).
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/image.h"
#include "manifest/sections/forward.h"

namespace gonio::scan {

enum class Axis : std::uint8_t { column, row };

struct Shown {
  enum class What : std::uint8_t { white, black, bit, cosine, line } what = What::white;
  Axis axis = Axis::column;
  int bit = 0;           // 0: the finest
  bool inverse = false;  // dark where the bit is set
  double periods = 1, shift_rad = 0;
  int period_px = 0, offset_px = 0;
  bool operator==(const Shown&) const = default;
};

struct Sequence {
  int width_px = 0, height_px = 0;
  std::vector<Shown> frames;
  int size(Axis axis) const { return axis == Axis::column ? width_px : height_px; }
  bool tells(Axis axis) const;  // bits, cosines or lines of it are shown
};

// In the order of OpenCV's structured_light module: bits of columns, bits of rows, white, black.
Sequence gray_sequence(int width_px, int height_px, std::span<const Axis> axes);
// For each axis, numbers of periods and shifts 0, 2 pi / shifts, ... in the order in which they are given.
Sequence cosine_sequence(int width_px, int height_px, std::span<const Axis> axes, std::span<const double> periods,
                         int shifts);

// Gray codes of stripes of half a period or less, lines at all offsets, white and black.
Sequence line_sequence(int width_px, int height_px, std::span<const Axis> axes, int period_px);

int bits_of(int size);  // of the numbers below it
int gray_code(int number);
int number_of_gray(int code);

// Light of a projector's pixel, 0 to 1; of cosines the mean over the pixel's width.
double light_at(const Sequence& sequence, std::size_t frame, int column, int row);
io::Image picture_of(const Sequence& sequence, std::size_t frame);  // Y

// As the manifest states it, and back. Error(data) for frames that say too little, or nothing (no bit is given twice,
// bits have no gap, each number of periods has three shifts, lines all offsets of one period and bits to tell them).
Sequence sequence_of(const manifest::Document& document, const std::string& name);
manifest::Projection projection_of(const Sequence& sequence);

}  // namespace gonio::scan
