// What moved while a stack of exposures was taken: regions of single pictures that show something else than the other
// pictures show there.
//
// On a grid of pixels each picture is held against the four others of the nearest exposures, one by one: what it makes
// of the other's reading is the median over all pixels of about that reading, whatever the camera's response is. A
// pixel departs by what is left beyond half a code, over the noise of both and over what a quarter of a pixel beside
// its place would read, as most of its partners agree; z sums three by three pixels. What the camera, a shutter or a
// lamp does to all pixels of one brightness alike singles none out. A region is where |z| > 3.5, and holds a |z| > 7:
// of Gaussian noise one stack of ten pictures in 10^6 has any.
#pragma once
#include <cstdint>
#include <vector>

#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

struct MovedRegion {  // of one picture: all that moved in it
  std::size_t image = 0;
  int left_px = 0, top_px = 0, width_px = 0, height_px = 0;  // the box about it
  double share = 0;                                          // of the picture
  double grid_px = 1;                                        // distance of the points that were looked at
  double relative = 0, sigma = 0;    // by which it is brighter than what the others show there: median; its error
  std::vector<std::uint8_t> inside;  // by pixel
};
struct Moved {
  std::vector<MovedRegion> regions;
  double p = 1;  // of the largest z among all places and pictures
  double with = 0,
         without = 0;  // relative RMSE of the readings about what their partners say, with these regions and without
  double effect = 0;   // root mean square of what moved over that of all readings
};

// At least three pictures must show a place. A picture of which over a third departs has none: that is no object.
Moved find_moved(const Stack& stack, const ReadingNoise& noise);
// Readings inside count no longer.
void leave_out(const Moved& moved, Stack& stack);

}  // namespace gonio::explain::stacks
