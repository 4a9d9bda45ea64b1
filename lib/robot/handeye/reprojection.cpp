// Levenberg-Marquardt over the twelve numbers of both mountings. A change of the mountings moves the predicted pose of
// the board so that the robot's deviation stays zero: by_pose * dT = -by_mountings * change.
#include "robot/handeye/reprojection.h"

#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "robot/handeye/pose_adjustment.h"

namespace gonio::robot::handeye {
namespace {

constexpr int most_steps = 60;
constexpr double no_outliers = 1e9;  // factor on sigma_px: plain squares

struct Normal {
  Matrix12 information = Matrix12::Zero();
  Vector12 gradient = Vector12::Zero();
  double squares = 0;
};

Normal normal_equations(const Setup& setup, const std::vector<View>& views, const Solution& s) {
  Normal n;
  for (const View& view : views) {
    const camera::BoardPose pose = predicted_pose(setup.kind, view, s);
    const CornerInformation c = corner_information(setup, view, pose, no_outliers);
    const Deviation d =
        deviation(setup.kind, {view.base_from_tool, pose, Matrix6::Identity(), true, setup.middle_m()}, s);
    const Matrix6x12 slope = -d.by_pose.partialPivLu().solve(d.by_mountings);
    n.information.noalias() += slope.transpose() * c.information * slope;
    n.gradient.noalias() += slope.transpose() * c.gradient;
    n.squares += c.in_front ? c.squares : HUGE_VAL;
  }
  return n;
}

}  // namespace

Solution minimise_reprojection(const Setup& setup, const std::vector<View>& views, const Solution& start) {
  Solution s = start;
  Normal at = normal_equations(setup, views, s);
  double damping = 1e-6;
  for (int step = 0; step < most_steps && damping < 1e8; ++step) {
    const Matrix12 damped = at.information + damping * Matrix12(at.information.diagonal().asDiagonal());
    const Vector12 change = -linear::solve_ldlt(damped, at.gradient);
    const Solution next = moved_by(s, change);
    const Normal there = normal_equations(setup, views, next);
    if (!(there.squares <= at.squares)) {
      damping *= 10;
      continue;
    }
    const bool done = at.squares - there.squares < 1e-12 * at.squares;
    s = next;
    at = there;
    damping = std::max(1e-12, damping * 0.1);
    if (done) break;
  }
  return s;
}

}  // namespace gonio::robot::handeye
