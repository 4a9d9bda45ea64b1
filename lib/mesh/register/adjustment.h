// Motions of all views together, by Gauss-Newton steps with pairs taken anew before each. For register.cpp.
//
// Pulls of data count by their own scatter: divided by the inflation, against the priors of stated poses. Directions
// that neither holds to `limit_m` get no step.
#pragma once
#include <Eigen/Core>

#include "mesh/register/joint_system.h"

namespace gonio::mesh {

struct Adjustment {
  std::vector<ViewMotion> motions;
  std::vector<ViewOverlap> overlaps;  // as the views end up
  MotionScale scale;
  JointSystem system;
  Eigen::MatrixXd covariance;  // of the unknowns, zero in open directions
  Eigen::MatrixXd open;        // columns: directions without a step
  double inflation = 1;
  int iterations = 0;
  bool converged = false;
};

std::vector<ViewOverlap> all_overlaps(const std::vector<ViewSurface>& surfaces, const std::vector<ViewMotion>& motions,
                                      double reach_m);

// `overlaps`: with no view moved.
Adjustment adjust(const std::vector<ViewSurface>& surfaces, std::vector<ViewOverlap> overlaps,
                  const std::vector<std::optional<PoseDoubt>>& doubts, const RegisterWish& wish, double reach_m);

}  // namespace gonio::mesh
