// Tracks that slipped: a point that, from some frame on, is followed beside where it is. Found by its jump between two
// frames against the jumps of all other points there; which tracks and when, never how far: that is fitted, and frames
// that were left out decide whether it is so.
#pragma once
#include <cstddef>
#include <vector>

#include "geom/vector.h"

namespace gonio::explain::tables {

struct TrackPoint {                  // one row of the table
  std::size_t frame = 0, point = 0;  // places in their orders
  Vec2 residual_px;                  // of the base model
};
struct Slip {
  std::size_t point = 0, from = 0;  // frame
};
// Jumps beyond six robust widths of the frame's that last, the largest first, no more than eight.
std::vector<Slip> find_slips(const std::vector<TrackPoint>& track_points, std::size_t frames, std::size_t points);

}  // namespace gonio::explain::tables
