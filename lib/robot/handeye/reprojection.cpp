// Levenberg-Marquardt over the twelve numbers of both mountings. A change of the mountings moves the predicted pose of
// the board so that the robot's deviation stays zero: by_pose * dT = -by_mountings * change.
#include "robot/handeye/reprojection.h"

#include <cmath>

#include "optim/damped.h"
#include "optim/descent.h"
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

struct Mountings final : optim::Descent {
  const Setup& setup;
  const std::vector<View>& views;
  Solution solution, next;
  Normal at, there;

  Mountings(const Setup& of, const std::vector<View>& seen, const Solution& start)
      : setup(of), views(seen), solution(start), next(start), at(normal_equations(of, seen, start)) {}
  void linearise() override {}  // evaluate() has
  optim::Proposal propose(double damping) override {
    const auto step = optim::damped_step(at.information, Vector12(-at.gradient), damping);
    next = moved_by(solution, step.change);
    return {step.promised};
  }
  double evaluate() override {
    there = normal_equations(setup, views, next);
    return there.squares;
  }
  void accept() override {
    solution = next;
    at = there;
  }
};

}  // namespace

Solution minimise_reprojection(const Setup& setup, const std::vector<View>& views, const Solution& start) {
  Mountings mountings(setup, views, start);
  optim::Limits limits;
  limits.most_trials = most_steps;
  limits.first_damping = 1e-6;
  limits.small_fall = limits.rounding = {1e-12, 0};
  optim::descend(mountings, mountings.at.squares, limits);
  return mountings.solution;
}

}  // namespace gonio::robot::handeye
