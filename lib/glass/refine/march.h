// A straight line through a body: where it enters and leaves, and where it comes deepest.
#pragma once
#include <vector>

#include "glass/refine/spline_field.h"

namespace gonio::glass {

struct Passage {
  struct Crossing {
    double t = 0;
    bool enters = true;
  };
  std::vector<Crossing> crossings;  // in their order; places along the line in cells
  bool meets_grid = false;
  double greatest = 0, at = 0;  // of the function along the line, and where
};

// From `origin` + t `direction` (cell coordinates, unit), t > `from`, through all of the grid. Features thinner than a
// quarter of a cell may be missed.
Passage passage(const SplineField& field, Vec3 origin, Vec3 direction, double from = 0);

}  // namespace gonio::glass
