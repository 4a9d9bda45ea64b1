// Cross-validation of a calibration: every other shot to one half, the rest to the other, each half calibrated alone,
// and the difference of their predictions over the image, after the rigid motion between their frames is taken out
// (alignment.h).
//
// Expected of it: the two halves share no corner, so their numbers' errors are independent, and to first order
//   dq = G (s_A - s_B),   cov = G (cov(s_A) + cov(s_B)) G',
// with G of projection_law.h over all views: the noise of a view's own corners moves its pose alike under both lenses
// and cancels. The mean square of dq over the image and the distances is held against its law, a weighted sum of
// squared normal numbers (drawn by a fixed seed), and the numbers themselves against their joint covariance: pixels at
// the image's edge hang on few numbers, and views that a wrong model pulls each in its own way show in all. `p` counts
// both looks; `level` is the chance that halves of a right model are called apart.
#pragma once
#include <string>
#include <vector>

#include "camera/quality/projection_map.h"

namespace gonio::camera {

struct Halves {
  std::string refused;                    // why there is no answer; empty: there is one
  double differ_px = 0, expected_px = 0;  // root mean square over the image and the distances
  double p = 1;
  bool agree = true;
  ImageGrid grid;
  std::vector<Vec2> difference_px;  // at the first distance, row by row; NaN: not seen
};
// A camera of a rig is compared by itself, without the others.
Halves compare_halves(const CameraResult& camera, const std::vector<double>& distances_m, double level = 0.01);

}  // namespace gonio::camera
