// Covariance of the sum of all pulls that follows from the points' own covariances alone: a point enters residuals of
// its own, and those of every other view's points in whose fits it takes part. To first order, errors along the normal.
#pragma once
#include "mesh/register/joint_system.h"

namespace gonio::mesh {

// `overlaps` are as the views lie by `motions`, and weighed.
Eigen::MatrixXd propagated_scatter(const std::vector<ViewSurface>& surfaces, const std::vector<ViewMotion>& motions,
                                   const std::vector<ViewOverlap>& overlaps, const MotionScale& scale,
                                   const JointSystem& system);

}  // namespace gonio::mesh
