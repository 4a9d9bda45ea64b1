#include "robot/handeye/views.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "camera/corner_model.h"
#include "optim/damped.h"
#include "optim/descent.h"
#include "robot/handeye/corner_information.h"

namespace gonio::robot::handeye {
namespace {

using camera::BoardColumn;
static_assert(BoardColumn::translation == BoardColumn::rotation + 3);

constexpr double huber_sigmas = 3;
constexpr int most_steps = 50, most_rounds = 30;
constexpr double same_noise = 1e-9;  // relative: from one round to the next

}  // namespace

CornerInformation corner_information(const Setup& setup, const View& view, const camera::BoardPose& pose,
                                     double factor) {
  CornerInformation sum;
  constexpr std::size_t none = BoardColumn::count;
  std::vector<std::size_t> lens_columns;
  for (const std::string& name : setup.lens_order)
    lens_columns.push_back(std::min(camera::corner_column(name).value_or(none), none));
  sum.lens = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(lens_columns.size()));
  std::array<std::array<double, BoardColumn::count>, 2> jacobian{};
  for (const SeenCorner& corner : view.corners) {
    Vec2 pixel;
    if (!camera::predict(setup.lens, pose, setup.extent, setup.warp, corner.board_m, pixel, jacobian)) {
      sum.in_front = false;
      continue;
    }
    const Vec2 r = pixel - corner.pixel;
    const double size = norm(r) / (corner.sigma_px * factor);
    const double robust = size > huber_sigmas ? huber_sigmas / size : 1;
    const double weight = robust / (corner.sigma_px * corner.sigma_px);
    sum.squares += weight * dot(r, r);
    const double knee = huber_sigmas * factor, z = size * factor;
    sum.cost += size > huber_sigmas ? 2 * knee * z - knee * knee : z * z;
    sum.coordinates += 2 * robust;
    for (const int row : {0, 1}) {
      const auto& j = jacobian[static_cast<std::size_t>(row)];
      const Eigen::Map<const Vector6> g(j.data() + BoardColumn::rotation);
      sum.information.noalias() += weight * g * g.transpose();
      sum.gradient.noalias() += weight * (row == 0 ? r.x : r.y) * g;
      for (std::size_t k = 0; k < lens_columns.size(); ++k) {
        if (lens_columns[k] == none) continue;
        sum.lens.col(static_cast<Eigen::Index>(k)) += weight * j[lens_columns[k]] * g;
      }
    }
  }
  return sum;
}

camera::BoardPose moved_by(const camera::BoardPose& pose, const Vector6& change) {
  return camera::moved(pose, {change(0), change(1), change(2), change(3), change(4), change(5)});
}

namespace {

// The pose for one size of the noise.
struct PoseDescent final : optim::Descent {
  const Setup& setup;
  const View& view;
  camera::BoardPose pose, next;
  double factor;
  CornerInformation at, there;

  PoseDescent(const Setup& of, const View& seen)
      : setup(of),
        view(seen),
        pose(seen.camera_from_board),
        next(pose),
        factor(1),
        at(corner_information(of, seen, pose, factor)) {}
  void linearise() override {}  // evaluate() has
  optim::Proposal propose(double damping) override {
    const auto step = optim::damped_step(at.information, Vector6(-at.gradient), damping);
    next = moved_by(pose, step.change);
    return {step.promised, std::sqrt(std::max(0.0, step.change.dot(at.information * step.change)))};
  }
  double evaluate() override {
    there = corner_information(setup, view, next, factor);
    return there.in_front ? there.cost : HUGE_VAL;
  }
  void accept() override {
    pose = next;
    at = there;
  }
};

}  // namespace

camera::BoardPose pose_by_camera(const Setup& setup, const View& view) {
  PoseDescent descent(setup, view);
  optim::Limits limits;
  limits.most_trials = most_steps;
  limits.first_damping = 1e-6;
  limits.small_fall = {};
  limits.rounding = {1e-12, 0};
  limits.small_step = 1e-9;
  for (int round = 0; round < most_rounds; ++round) {
    const double before = descent.factor;
    descent.factor = std::sqrt(std::max(1.0, descent.at.squares / std::max(1.0, descent.at.coordinates - 6)));
    if (round > 0 && std::abs(descent.factor - before) <= same_noise * before) break;
    descent.at = corner_information(setup, view, descent.pose, descent.factor);
    optim::descend(descent, descent.at.cost, limits);
  }
  return descent.pose;
}

std::vector<PoseSample> samples_of(const Setup& setup, const std::vector<View>& views) {
  std::vector<PoseSample> samples;
  for (const View& view : views) samples.push_back(sample_of(setup.kind, view.base_from_tool, view.camera_from_board));
  return samples;
}

camera::BoardPose predicted_pose(Kind kind, const View& view, const Solution& solution) {
  const PoseSample sample = sample_of(kind, view.base_from_tool, {});
  return inverse(solution.mount_from_camera) * inverse(sample.stand_from_mount) * solution.stand_from_board;
}

double rms_px(const Setup& setup, const View& view, const camera::BoardPose& pose) {
  double squares = 0;
  for (const SeenCorner& corner : view.corners) {
    Vec2 pixel;
    if (!camera::predict(setup.lens, pose, setup.extent, setup.warp, corner.board_m, pixel)) return HUGE_VAL;
    const Vec2 r = corner.pixel - pixel;
    squares += dot(r, r);
  }
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, view.corners.size())));
}

}  // namespace gonio::robot::handeye
