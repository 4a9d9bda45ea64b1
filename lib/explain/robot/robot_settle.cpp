// See robot_findings.h: reference poses, alignment, noise, and the conditions of a view.
#include <algorithm>
#include <cmath>

#include "explain/robot/robot_findings.h"
#include "linear/solve.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

constexpr int pose_iterations = 4;

// A turn of the tool, a shift of it, and a turn of the seen board about its middle, by which its origin follows.
robot::handeye::PoseScatter scatter_of(const RobotWork& work, std::size_t view, const ChainState& state,
                                       const PoseMatrix& measured) {
  const PoseMatrix by = matrix_of(by_tool(work.input, work.input.views[view], state));
  const Vec3 arm = work.reference[view].rotate({work.input.extent.middle_m.x, work.input.extent.middle_m.y, 0});
  Eigen::Matrix<double, 6, 3> by_board;
  by_board << 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -arm.z, arm.y, arm.z, 0, -arm.x, -arm.y, arm.x, 0;
  robot::handeye::PoseScatter s;
  std::ranges::copy(measured.reshaped(), s.measured.begin());
  std::ranges::copy(by.leftCols<3>().reshaped(), s.by_turn.begin());
  std::ranges::copy(by.rightCols<3>().reshaped(), s.by_shift.begin());
  std::ranges::copy(by_board.reshaped(), s.by_board.begin());
  return s;
}

// Derivatives of pose_difference() by all parameters.
Eigen::MatrixXd differences(const RobotWork& work, std::size_t view, const std::vector<double>& values) {
  std::vector<std::size_t> columns(values.size());
  for (std::size_t p = 0; p < columns.size(); ++p) columns[p] = p;
  Eigen::MatrixXd slopes = chain_slopes(work, view, values, columns);
  const Eigen::MatrixXd measured = pose_slopes(work, view, state_of(work.input, work.parameters, values));
  for (std::size_t p = 0; p < columns.size(); ++p) {
    const RobotRole& role = work.parameters.roles[p];
    if (moves_camera_or_board(role.part)) slopes.col(static_cast<Eigen::Index>(p)) = -measured.col(slope_column(role));
  }
  return slopes;
}

NoisyView noisy_view(const RobotWork& work, std::size_t view, const std::vector<double>& values,
                     const PoseMatrix& measured) {
  const ChainState state = state_of(work.input, work.parameters, values);
  return {-pose_difference(work, view, state), differences(work, view, values),
          scatter_of(work, view, state, measured)};
}

// Gauss-Newton on the two mountings alone. Poses weigh by a plain 1 mrad and 1 mm, with Huber's loss so that single bad
// poses do not bend the start.
void align(RobotWork& work) {
  const std::vector<std::size_t>& base = work.parameters.base;
  constexpr double rotation = 1e-3, shift = 1e-3;
  for (int round = 0; round < 30; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(12, 12);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(12);
    std::vector<PoseChange> residuals;
    std::vector<double> sizes;
    for (std::size_t v = 0; v < work.input.views.size(); ++v) {
      residuals.push_back(pose_difference(work, v, state_of(work.input, work.parameters, work.aligned)));
      residuals.back().head<3>() /= rotation;
      residuals.back().tail<3>() /= shift;
      sizes.push_back(residuals.back().norm());
    }
    const double knee = std::max(2 * stats::median(sizes), 1e-6);
    for (std::size_t v = 0; v < work.input.views.size(); ++v) {
      Eigen::MatrixXd j = differences(work, v, work.aligned)(Eigen::all, Eigen::seqN(0, 12));
      j.topRows<3>() /= rotation;
      j.bottomRows<3>() /= shift;
      const double weight = sizes[v] > knee ? knee / sizes[v] : 1;
      normal += weight * j.transpose() * j;
      gradient -= weight * j.transpose() * residuals[v];
    }
    const Eigen::VectorXd scale = normal.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
    Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    scaled.diagonal().array() += 1e-10;
    const Eigen::VectorXd step =
        scale.asDiagonal() * linear::solve_ldlt(scaled, Eigen::VectorXd(scale.asDiagonal() * gradient));
    for (std::size_t k = 0; k < 12; ++k) work.aligned[base[k]] += step[static_cast<Eigen::Index>(k)];
    if (step.norm() < 1e-9) break;
  }
}

template <class T>
void erase_marked(std::vector<T>& list, const std::vector<bool>& marked) {
  std::vector<T> kept;
  for (std::size_t k = 0; k < list.size(); ++k)
    if (!marked[k]) kept.push_back(std::move(list[k]));
  list = std::move(kept);
}

}  // namespace

Eigen::VectorXd prior_precision(const RobotParameters& parameters) {
  Eigen::VectorXd precision(static_cast<Eigen::Index>(parameters.parameters.size()));
  for (std::size_t k = 0; k < parameters.parameters.size(); ++k) {
    const Parameter& p = parameters.parameters[k];
    const double width = p.prior_sigma ? *p.prior_sigma : std::isfinite(p.upper) ? p.size : 0;
    precision[static_cast<Eigen::Index>(k)] = width > 0 ? 1 / (width * width) : 0;
  }
  return precision;
}

std::vector<double> start_values(const RobotWork& work) {
  return work.aligned;
}

namespace {

// The measured pose under a state's camera and board.
camera::BoardPose measured_under(const RobotWork& work, const ChainInput::View& v, const camera::BoardPose& reference,
                                 const ChainState& state) {
  const camera::Intrinsics& base = work.input.intrinsics;
  const bool same = state.intrinsics.fx_px == base.fx_px && state.intrinsics.fy_px == base.fy_px &&
                    state.intrinsics.cx_px == base.cx_px && state.intrinsics.cy_px == base.cy_px &&
                    state.intrinsics.distortion == base.distortion && state.warp.sag_x_m == work.input.warp.sag_x_m &&
                    state.warp.sag_y_m == work.input.warp.sag_y_m && state.scale == std::array<double, 2>{};
  if (same || v.corners.empty()) return reference;
  return measured_pose(v, work.input, state, reference, pose_iterations).camera_from_board;
}

}  // namespace

PoseChange pose_difference(const RobotWork& work, const ChainInput::View& view, const camera::BoardPose& reference,
                           const ChainState& state) {
  return vector_of(change_between(measured_under(work, view, reference, state), chain_pose(work.input, view, state)));
}

PoseChange pose_difference(const RobotWork& work, std::size_t view, const ChainState& state) {
  return pose_difference(work, work.input.views[view], work.reference[view], state);
}

// Central differences with steps of 1e-4 of the typical size.
Eigen::MatrixXd chain_slopes(const RobotWork& work, std::size_t view, std::vector<double> values,
                             std::span<const std::size_t> columns) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(6, n);
  const ChainInput::View& v = work.input.views[view];
  const camera::BoardPose& from = work.reference[view];
  for (Eigen::Index c = 0; c < n; ++c) {
    const std::size_t p = columns[static_cast<std::size_t>(c)];
    if (moves_camera_or_board(work.parameters.roles[p].part)) continue;
    const double step = 1e-4 * work.parameters.parameters[p].size, middle = values[p];
    values[p] = middle + step;
    const PoseChange up =
        vector_of(change_between(from, chain_pose(work.input, v, state_of(work.input, work.parameters, values))));
    values[p] = middle - step;
    const PoseChange down =
        vector_of(change_between(from, chain_pose(work.input, v, state_of(work.input, work.parameters, values))));
    values[p] = middle;
    slopes.col(c) = (up - down) / (2 * step);
  }
  return slopes;
}

Eigen::MatrixXd pose_slopes(const RobotWork& work, std::size_t view, const ChainState& state) {
  const ChainInput::View& v = work.input.views[view];
  if (v.corners.empty()) return Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(slope_scale + 2));
  const std::vector<double> slopes =
      measured_slopes(v, work.input, state, measured_under(work, v, work.reference[view], state));
  return Eigen::Map<const Eigen::MatrixXd>(slopes.data(), 6, static_cast<Eigen::Index>(slopes.size() / 6));
}

void settle(RobotWork& work) {
  for (const Parameter& p : work.parameters.parameters) work.aligned.push_back(p.neutral);
  const ChainState base = state_of(work.input, work.parameters, work.aligned);
  std::vector<PoseMatrix> covariances;
  double squares = 0, freedom = 0;
  for (const ChainInput::View& view : work.input.views) {
    const MeasuredPose m = measured_pose(view, work.input, base, view.camera_from_board, 20);
    work.reference.push_back(m.camera_from_board);
    covariances.push_back(matrix_of(m.covariance));
    squares += m.squares;
    freedom += m.freedom;
  }
  // Corners scatter as they do about the poses of all views, whatever was stated: a view's own are too few to say.
  if (freedom >= 1)
    for (PoseMatrix& covariance : covariances) covariance *= squares / freedom;
  align(work);
  for (std::size_t v = 0; v < work.input.views.size(); ++v)
    work.noisy.push_back(noisy_view(work, v, work.aligned, covariances[v]));
  work.noise = robot_noise(work.noisy, prior_precision(work.parameters));
  for (std::size_t v = 0; v < work.input.views.size(); ++v)
    if (work.noise.outlier[v]) work.outliers.push_back(work.input.views[v].image);
  erase_marked(work.input.views, work.noise.outlier);
  erase_marked(work.reference, work.noise.outlier);
  erase_marked(work.noisy, work.noise.outlier);
}

namespace {

double speed(const ChainInput::View& v) {
  return std::hypot(v.velocity[3], v.velocity[4], v.velocity[5]);
}

// Conditions of recordings that say when they were taken.
struct Drift {
  const char *name, *unit, *curve_unit;
  double (*of)(const ChainInput::View& view);
};
constexpr Drift drifts[] = {{"robot.temperature", "K", "1", [](const ChainInput::View& v) { return v.warmer_K; }},
                            {"robot.time", "s", "1", [](const ChainInput::View& v) { return v.later_s; }},
                            {"robot.speed", "m/s", "s", [](const ChainInput::View& v) { return speed(v); }}};

bool varies(const RobotWork& work, double (*of)(const ChainInput::View& view)) {
  return std::ranges::any_of(work.input.views, [&](const ChainInput::View& v) { return of(v) != 0; });
}

}  // namespace

std::vector<Condition> robot_conditions(const RobotWork& work) {
  std::vector<Condition> conditions = {{"robot.reach", "m", "pose", {}, {}, "m"},
                                       {"camera.distance", "m", "lens", {}, {}, "m"},
                                       {"camera.obliqueness", "rad", "board", {}, {}, "m"}};
  for (const Drift& drift : drifts)
    if (varies(work, drift.of)) conditions.push_back({drift.name, drift.unit, "pose", {}, {}, drift.curve_unit});
  if (work.input.links.empty() || work.input.views[0].joints_rad.empty()) return conditions;
  for (std::size_t j = 1; j + 1 < std::min<std::size_t>(6, work.input.links.size()); ++j) {
    conditions.push_back({"robot.joint-" + std::to_string(j + 1), "rad", "pose", {}, {}, "rad"});
    conditions.push_back({"robot.approach-" + std::to_string(j + 1), "1", "pose", {}, {}, "rad"});
  }
  return conditions;
}

// Directions: a drop of the tool (reach), a shift along the line of sight (distance, obliqueness), growth of the arm
// (temperature, time), the way of the tool (speed), a turn about the joint's axis (joint, approach).
void append_robot_conditions(const RobotWork& work, std::size_t view, const PoseMatrix& whitener,
                             std::vector<Condition>& conditions) {
  const ChainInput::View& v = work.input.views[view];
  const ChainState state = state_of(work.input, work.parameters, work.aligned);
  const auto tool = tool_pose(work.input, v, state);
  const PoseMatrix by = matrix_of(by_tool(work.input, v, state));
  const camera::BoardPose& board = work.reference[view];
  const auto append = [&](std::size_t k, double value, const PoseChange& direction) {
    const PoseChange whitened = whitener * direction;
    for (Eigen::Index i = 0; i < 6; ++i) {
      conditions[k].values.push_back(value);
      conditions[k].direction.push_back(whitened[i]);
    }
  };
  const auto tool_change = [&](Vec3 turn, Vec3 shift) {  // in the base's axes
    const auto back = inverse(tool);
    const Vec3 w = back.rotate(turn), s = back.rotate(shift);
    PoseChange xi;
    xi << w.x, w.y, w.z, s.x, s.y, s.z;
    return PoseChange(by * xi);
  };
  append(0, std::hypot(tool.translation_m.x, tool.translation_m.y), tool_change({}, {0, 0, -1}));
  const Vec3 sight = normalized(board.translation_m);
  PoseChange along = PoseChange::Zero();
  along.tail<3>() << sight.x, sight.y, sight.z;
  append(1, norm(board.translation_m), along);
  append(2, std::acos(std::clamp(std::abs(dot(board.rotate({0, 0, 1}), sight)), 0.0, 1.0)), along);
  std::size_t next = 3;
  for (const Drift& drift : drifts) {
    if (!varies(work, drift.of)) continue;
    const bool moves = drift.of == drifts[2].of;
    append(
        next++, drift.of(v),
        moves ? PoseChange(by * Eigen::Map<const PoseChange>(v.velocity.data())) : tool_change({}, tool.translation_m));
  }
  if (next == conditions.size()) return;
  const std::vector<robot::Motion> motions = robot::joint_motions(work.input.links, v.joints_rad);
  for (std::size_t joint = 1; next < conditions.size(); ++joint) {
    const PoseChange turned = tool_change(motions[joint].turn_rad, motions[joint].shift_m);
    append(next++, v.joints_rad[joint], turned);
    append(next++, v.approach[joint], turned);
  }
}

}  // namespace gonio::explain
