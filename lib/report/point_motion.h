// Two sets of points that move, in space: one that was found and the true one, with lines between points that belong
// together, coloured by their distance. A drawing of one frame that the page's script, where it runs, replaces by a
// view that one turns (drag, arrow keys) and plays.
//
// Points are projected in parallel: p -> (turn p)_xy, y up, z towards the reader; the true ones of all frames fit into
// the picture. They are stored with 12 bits a coordinate, two characters each, in a cube about the true ones of twice
// their longest side, in steps of 1/4094 of it; what was found farther off stands at its border.
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace gonio::report {

struct PointMotion {
  std::string name;                                       // what is shown, for readers who do not see
  std::string unit;                                       // of lengths as given
  std::vector<int> frames;                                // numbers of the frames shown
  std::size_t points = 0;                                 // of each frame
  std::vector<float> truth, found;                        // x, y, z of every point, frame by frame; NaN: not there
  std::vector<std::pair<int, int>> links;                 // points that a thin line joins, in the truth
  double full = 0;                                        // distance that has the last colour; 0: the largest
  std::array<double, 9> turn{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row by row, at the beginning
};

// For Figure::svg. `truth` and `found` have 3 x points x frames numbers.
std::string html(const PointMotion& motion);

// A view along the direction in which the points of the truth are spread least, tilted: their longest extent lies
// across.
std::array<double, 9> turn_for(const PointMotion& motion);

}  // namespace gonio::report
