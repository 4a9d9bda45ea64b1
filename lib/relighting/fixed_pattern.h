// What stays with the pixels of a sensor while the picture moves over them, told apart from what stays with the scene.
//
// A pixel's deviation is its value over what a quadratic surface through its 24 neighbours gives in its place (Savitzky
// & Golay 1964), less one; shading cancels in it, and places where the neighbours themselves are further from that
// surface than in most of the picture (edges, texture) are passed over. The pattern that one view is held against comes
// from other views of the same camera alone, whose noise is not that view's. Every pair of views is used in one
// direction only: were each held against the other, one coincidence would be counted twice.
#pragma once
#include <vector>

#include "relighting/recordings.h"

namespace gonio::relighting {

struct FixedPattern {
  // Rows from the top, three colours for each pixel; NaN where nothing is known.
  struct OfView {
    std::vector<float> deviation;  // mean in the pictures of the views that this one is held against
    std::vector<float> normal;     // best linear guess of the pixel's own sensitivity less one, over `size`
    double size = 0;               // standard deviation of the sensitivities of this view's camera; 0: no pattern
    bool any = false;
  };
  std::vector<OfView> views;
};
FixedPattern fixed_pattern(const Recordings& recordings);

}  // namespace gonio::relighting
