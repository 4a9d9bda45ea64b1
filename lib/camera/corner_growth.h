// Corners beside corners: outwards from those that are known, each where the homography of its neighbours expects it.
// For sources of this folder only.
#pragma once
#include <vector>

#include "camera/corner_detection.h"
#include "camera/corner_refinement.h"
#include "camera/grey_picture.h"

namespace gonio::camera {

struct Growth {
  double clear_share = 1;  // as refine() takes it
  int rounds = 3;
  // Prediction::bare of a corner: plain boards have none.
  int (*bare)(const Board& board, int corner, bool legacy) = nullptr;
  bool legacy = false;
};

// Adds to `corners` (numbered as `board` numbers them, sorted by id) what is found beside them: new ones must lie where
// they are expected, to a tenth of a square, and be as sharp as the others, to a factor of three.
void grow(const GreyPicture& picture, const Board& board, const Growth& growth, const DetectionOptions& options,
          std::vector<Corner>& corners);

}  // namespace gonio::camera
