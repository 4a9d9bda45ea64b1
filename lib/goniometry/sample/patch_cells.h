// Parts of a patch: how evenly it reflects. Place x, y in units of the patch's extent about its middle.
#pragma once
#include <vector>

#include "geom/vector.h"

namespace gonio::goniometry {

struct PatchCell {
  Vec2 at;
  Rgb ratio, variance;  // of the cell's mean; variance not a number: noise not known
  Rgb weight;           // share of the patch's whole
  double middle = 0;    // median of its pixels' ratios, mean over bands: glints do not move it
};

// Variance of sum(weight * ratio) as the cells' scatter about a smooth course has it, per band, and the degrees of
// freedom that it rests on; 0 where there are too few cells.
struct Scatter {
  Rgb variance;
  int degrees = 0;
};
Scatter scatter_of(const std::vector<PatchCell>& cells);

// Cells that leave the course of the majority; patch_reading.h. `farthest`: relative to the course.
struct Outlying {
  int count = 0;
  double farthest = 0;
};
Outlying outlying_cells(const std::vector<PatchCell>& cells);

}  // namespace gonio::goniometry
