// One rigid shape and the cameras that see it: least reprojection error over visible tracks.
//   min sum |w_fp - s_f R_f x_p - t_f|^2
// by Levenberg-Marquardt on all of them. A frame meets other frames only in the points, so that its camera is
// eliminated, or the points are, whichever leaves the smaller system (Triggs et al. 2000, section 6). Tracks of a shape
// that is nearly flat fit two poses per frame, one the other mirrored in depth about the plane: each frame's other pose
// is tried where the search ends, and the search goes on from what is better.
//
// The metric upgrade (factorization.h) minimizes errors of orthonormality, in which a direction that tracks hardly show
// counts as much as any: for sheets and other flat shapes its rotations can be off by 60 degrees where these are off by
// a few.
#pragma once
#include "nrsfm/solve/factorization.h"

namespace gonio::nrsfm {

struct RigidMotion {
  std::vector<WeakCamera> cameras;  // their scales' mean is 1
  Eigen::Matrix3Xd shape;           // 3 x P, mean zero
  double cost = 0;
  int iterations = 0;
  bool converged = false;
};
struct RigidOptions {
  bool free_scales = false;
  int most_iterations = 200;
  double tolerance = 1e-9;  // relative, of the cost
};
RigidMotion refine_rigid(const Sequence& sequence, std::vector<WeakCamera> start, const RigidOptions& options);

// The shape that visible tracks want, given the cameras.
Eigen::Matrix3Xd rigid_shape(const Sequence& sequence, const std::vector<WeakCamera>& cameras);

}  // namespace gonio::nrsfm
