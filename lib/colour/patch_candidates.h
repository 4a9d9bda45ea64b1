// Quadrilaterals of one colour in a picture that may be patches of a chart, and lattices of such.
#pragma once
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "geom/vector.h"
#include "io/image.h"

namespace gonio::colour {

struct Quad {
  std::array<Vec2, 4> corners{};  // clockwise on the screen
  Vec2 centre{};
  double side = 0;  // root of the area
};

// R, G, B of `picture` over their 99th percentiles, cube roots, 8 bits: what a threshold sees light and dark parts of
// alike in. Shrunk by `shrink` (1: as it is), each pixel the mean of those that it stands for.
cv::Mat lightness_picture(const io::Image& picture, double shrink);

// Distinct quadrilaterals, in the picture's pixels.
std::vector<Quad> patch_candidates(const cv::Mat& picture);

// Quads with whole-numbered places in a common lattice; columns and rows grow as the first quad's sides do, and turn
// clockwise.
struct LatticeCell {
  std::size_t quad = 0;
  int column = 0, row = 0;
};
using Lattice = std::vector<LatticeCell>;
// `share`: width of a patch over the distance of centres. Lattices of at least `least` cells, the largest first.
std::vector<Lattice> lattices(const std::vector<Quad>& quads, double share, std::size_t least);

}  // namespace gonio::colour
