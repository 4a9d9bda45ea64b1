// Refinement of one view: the shift in the picture that lays the pattern onto it best, within what the pose leaves
// open.
//
// Over a grid of 8 x 8 points in every cell, minimise sum (I(q + s) - m(p))^2 / r^2 + |s|^2 / sigma^2 for the shift s,
// by Gauss and Newton: I the picture, interpolated linearly, q the pixel of the point p, m what its cell's class has
// there. r^2 is the mean square of what remains, times the points per pixel, because points that share a pixel share
// its error. The edges between cells decide; without contrast the shift stays at zero.
#pragma once
#include <vector>

#include "contrast/pattern.h"
#include "contrast/segmentation.h"
#include "contrast/view_map.h"

namespace gonio::contrast {

struct ViewShift {
  Vec2 by_px;
  double sigma_px = 0;  // of one coordinate
};
// `expected[cell]`: of the cell's class. `sigma_px`: of the place before.
ViewShift shift_onto(const GreyView& view, const CellPattern& pattern, const ViewMap& map,
                     const std::vector<double>& expected, double sigma_px);

}  // namespace gonio::contrast
