// Which part of the image the corners reach: cells whose middle lies within the outline (convex hull) of some view's
// corners.
#pragma once
#include <vector>

#include "camera/quality/projection_map.h"

namespace gonio::camera {

struct Coverage {
  ImageGrid grid;
  std::vector<int> views;  // how many reach a cell, row by row
  double share = 0;        // of the cells that at least one view reaches
};
Coverage coverage_of(const CameraResult& camera);
io::Image picture_of(const Coverage& coverage);  // sRGB codes; white: no view

}  // namespace gonio::camera
