// Tracks that slipped: a point that, from some frame on, is followed beside where it is. Found by the step of its mean
// residual between the frames before and those from there on, against the steps of all other points at the same frame:
// what the camera or the model does to all of them widens these, and singles no one out. Which tracks and when, never
// how far: that is fitted, and frames that were left out decide whether it is so.
#pragma once
#include <cstddef>
#include <vector>

#include "geom/vector.h"

namespace gonio::explain::tables {

struct TrackPoint {                  // one row of the table
  std::size_t frame = 0, point = 0;  // places in their orders
  Vec2 residual_px;                  // of the base model
};
inline constexpr std::size_t most_slips = 8;

struct Slip {
  std::size_t point = 0, from = 0;  // frame
  Vec2 towards;                     // unit vector
};
// Steps beyond six robust widths, each point's widest, the largest first, no more than most_slips. Sixty points of
// Gaussian noise have one in some 10^5 films of sixteen frames.
std::vector<Slip> find_slips(const std::vector<TrackPoint>& track_points, std::size_t frames, std::size_t points);

}  // namespace gonio::explain::tables
