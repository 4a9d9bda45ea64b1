// The joint refinement of hand-eye calibration: all corners of all images and all poses of the robot at once.
//
// Unknown are the two mountings X = mount_from_camera, Z = stand_from_board, and at every view where the robot truly
// was. Minimised is
//   sum over corners |found - predicted|^2 / (s sigma_px)^2
//     + sum over views |d_t|^2 / robot_m^2 + |d_r|^2 / robot_rad^2 + |b|^2 / board_rad^2,
// d_t, d_r: shift and rotation vector (about the tool's origin, in the base's axes) by which the robot deviates from
// its controller's word; b: a turn of the seen board about its middle beyond the corners' noise, as lenses that are not
// quite calibrated and boards that are not quite flat produce. A pure reprojection error has robot_m = robot_rad = 0
// and pulls the camera after the robot's errors; a pure pose error forgets that a camera knows some directions ten
// times better than others. Here the noises themselves weigh them: s from the corners' residuals at poses fitted to
// each view alone, the others by restricted maximum likelihood (pose_noise.h).
//
// The board's pose in a view is eliminated (Schur complement over views): what the corners say of it is a pose with a
// covariance, re-linearised at the joint estimate, so that the minimum is that of the sum above. Deviations that are
// the same at all poses cannot be told from the mountings; what a bad lens does to distances counts as robot noise.
#pragma once
#include <array>
#include <vector>

#include "robot/handeye/noise.h"
#include "robot/handeye/views.h"

namespace gonio::robot::handeye {

// Where the robot seems to have been in a view, by the camera and the solution, against what its controller said: shift
// of the tool's origin and turn about it, in the base's axes.
struct Mismatch {
  Vec3 shift_m, turn_rad;
  double distance2 = 0;  // squared Mahalanobis distance, 6 degrees of freedom
};
struct Refined {
  Solution solution;
  // Rows: turn of X (rad, about the mount's axes through the camera), shift of X (m, mount's axes), then Z alike in the
  // stand's. Row-major; widened by Student's t for the few views that the noises were estimated from, so that 1.96
  // sigmas are 95 %. `from_lens` is the part of it that the lens's covariance brings.
  std::array<double, 144> covariance{}, from_lens{};
  std::array<double, 144> information{};  // its inverse without the lens and the widening
  Noise noise;
  std::vector<Mismatch> mismatches;                  // one per view, also those that did not count
  std::vector<camera::BoardPose> camera_from_board;  // joint estimate, one per view
  bool converged = false;
  double sigma(std::size_t parameter) const;
};

// `counts[i]`: does view i count? At least three must. The views' camera_from_board must be pose_by_camera().
Refined refine(const Setup& setup, const std::vector<View>& views, const std::vector<bool>& counts,
               const Solution& start);

}  // namespace gonio::robot::handeye
