// Shapes of a low-rank model as points of a curve.
#pragma once
#include "nrsfm/solve/shape_trajectory.h"

namespace gonio::nrsfm {

// Rows y_f with |y_f - y_g| the distance of the shapes of frames f and g, in principal axes, less their mean; its first
// `dimensions` columns, in falling order.
Eigen::MatrixXd principal_coordinates(const ShapeTrajectory& fit, Eigen::Index dimensions);

}  // namespace gonio::nrsfm
