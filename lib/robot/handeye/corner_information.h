// What the corners of one view say about the board's pose: normal equations of the camera's forward model at a pose.
// For sources of this folder only.
//
// Columns are those of camera::moved(): rotation vector about the camera's axes through the board's origin, then
// translation. Squares are of residuals over sigma_px, weighted by Huber's function at three standard deviations of
// sigma_px * factor.
#pragma once
#include "robot/handeye/matrices.h"
#include "robot/handeye/views.h"

namespace gonio::robot::handeye {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

struct CornerInformation {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();  // half the derivative of the cost
  Eigen::MatrixXd lens;                // 6 x lens_order: cross terms with the lens
  double squares = 0, coordinates = 0;
  double cost = 0;       // Huber's: what the gradient is half the derivative of
  bool in_front = true;  // false: some corner lies behind the camera
};
CornerInformation corner_information(const Setup& setup, const View& view, const camera::BoardPose& pose,
                                     double factor);
camera::BoardPose moved_by(const camera::BoardPose& pose, const Vector6& change);

}  // namespace gonio::robot::handeye
