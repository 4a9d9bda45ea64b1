// Where a camera sees each pixel of the projector. For this room.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "scan/decode.h"

namespace gonio::scan {

struct CodePlace {
  std::int64_t code = 0;  // row times width plus column of the projector
  Vec2 pixel;             // of the camera
  Vec2 variance_px2;      // along x and y: columns are often told better than rows, or worse
  float reflected = 0;
};

// Ascending codes. Both axes must be told. A pixel of the projector is seen by a few of the camera, of which a Gray
// code tells no more than that: its middle is that of a plane, pixel over code, through it and its eight neighbours,
// unless these do not lie on one (an edge of the scene); then the centroid.
// Ambiguous pixels (below) do not count, and are counted.
std::vector<CodePlace> places_of(const Codes& codes, int projector_width_px, std::size_t* ambiguous = nullptr);

// By how much variances of places under whole stripes are too small, 1 at least. What stripes upon pixels leave of
// neighbouring cells goes up and down like a saw, and does not average out. Places of cells that share no pixel say how
// much it is: third differences p(0) - 3 p(n) + 3 p(2 n) - p(3 n), squared, over what their variances make of them; the
// mean over many n, as single ones meet the saw's own period; along columns and along rows, of which each hides what
// the other shows; of x and of y the mean.
double saw_factor(std::span<const CodePlace> places, int projector_width_px);

// Pixels that tell a pixel of the projector which others, apart from them, tell as well. Of such clusters the one is
// right whose neighbours tell neighbouring pixels of the projector twice as often as about any other; all are ambiguous
// where there is none. Nothing where one axis alone is told.
std::vector<std::uint32_t> ambiguous_pixels(const Codes& codes, int projector_width_px);

}  // namespace gonio::scan
