// A surface in space, shaded, which the reader turns (drag, arrow keys) and brings nearer (wheel, + and -); by the
// page's script and WebGL. Without either, and on paper, a picture of it stands there. Several surfaces over one
// another are switched by name: the same view of each.
//
// Parallel projection as in point_motion.h: p -> (turn p)_xy, y up, z towards the reader. Positions are stored with 16
// bits a coordinate in the cube about all surfaces.
//
// A model that moves (io/moving_model.h) is drawn instead where one is given: every mesh once, its nodes' places, and
// the hinges' angles at the keys in single precision, from which the script composes the places at any time. A slider,
// the space bar and buttons lead through the time, labels stand at their nodes, and plots of the page that are drawn
// over time (Plot::over_time) get a line at the time that is shown.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/moving_model.h"

namespace gonio::report {

struct ViewedMesh {
  std::string name;  // of the switch
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<float> value;                             // one a vertex, coloured; or empty: grey
};
struct ColourKey {  // of a legend: what a colour of the model's palette means
  int colour = 0;
  std::string words;
};
struct MeshView {
  std::string name;  // what is shown, for readers who do not see
  std::vector<ViewedMesh> meshes;
  std::string label, unit;                                 // of the values
  double low = 0, high = 0;                                // of the colours; both 0: no values. low < 0: signed colours
  std::array<double, 9> turn{1, 0, 0, 0, 0, 1, 0, -1, 0};  // row by row, at the beginning: z up, seen along +y
  io::MovingModel moving{};                                // with nodes: drawn, and no meshes
  double start_s = 0;                                      // the time that is shown first
  std::vector<ColourKey> legend{};
};

// For Figure::svg. Error-free for meshes without triangles.
std::string html(const MeshView& view);

// The picture: the first mesh (or `which`), lit from the reader's left shoulder, as the bytes of a PNG.
std::string still_png(const MeshView& view, std::size_t which, int width, int height);

}  // namespace gonio::report
