// What stays with the pixels of a sensor while the picture moves over them, told apart from what stays with the scene.
//
// A pixel's deviation is its value over the mean of its eight neighbours, less one; shading cancels in it, and places
// where the neighbours themselves differ by more than noise can make (edges, texture) are passed over. The pattern that
// one view is held against comes from other views of the same camera alone, whose noise is not that view's. Every pair
// of views is used in one direction only: were each held against the other, one coincidence would be counted twice.
#pragma once
#include <vector>

#include "relighting/recordings.h"

namespace gonio::relighting {

// For each view and pixel, rows from the top, three colours: the mean deviation in the pictures of the views that this
// one is held against, and the variance of that mean by the pictures' noise. NaN where there are none.
struct FixedPattern {
  struct OfView {
    std::vector<float> deviation, variance;
    bool any = false;
  };
  std::vector<OfView> views;
};
FixedPattern fixed_pattern(const Recordings& recordings);

}  // namespace gonio::relighting
