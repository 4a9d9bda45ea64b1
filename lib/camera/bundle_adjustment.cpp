// The adjustment itself: Ceres over the templates of board_terms.h.
//
// Blocks: [fx, fy / fx, cx, cy], so that the aspect ratio can be held; distortion; sag; per view a unit quaternion and
// a translation.
#include "camera/bundle_adjustment.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>

namespace gonio::camera {
namespace {

constexpr int most_iterations = 200;

struct CornerCost {
  Vec2 pixel, at_m;
  BoardExtent extent;
  double root_weight;

  template <class T>
  bool operator()(const T* pinhole, const T* distortion, const T* sag, const T* rotation, const T* translation,
                  T* residual) const {
    const T point[3] = {T(at_m.x), T(at_m.y), board_height(extent, at_m, sag)};
    T seen[3];
    ceres::UnitQuaternionRotatePoint(rotation, point, seen);
    for (int i = 0; i < 3; ++i) seen[i] += translation[i];
    const T intrinsics[4] = {pinhole[0], pinhole[0] * pinhole[1], pinhole[2], pinhole[3]};
    T predicted[2];
    if (!project_point(seen, intrinsics, distortion, predicted)) return false;
    residual[0] = root_weight * (predicted[0] - pixel.x);
    residual[1] = root_weight * (predicted[1] - pixel.y);
    return true;
  }
};

struct Blocks {
  std::array<double, 4> pinhole;
  std::array<double, distortion_terms> distortion;
  std::array<double, 2> sag;
  std::vector<std::array<double, 4>> rotations;
  std::vector<std::array<double, 3>> translations;
};

Blocks blocks_of(const Adjustment& state) {
  Blocks b;
  const Intrinsics& lens = state.lens;
  b.pinhole = {lens.fx_px, lens.fy_px / lens.fx_px, lens.cx_px, lens.cy_px};
  b.distortion = lens.distortion;
  b.sag = {state.warp.sag_x_m, state.warp.sag_y_m};
  for (const BoardPose& pose : state.poses) {
    b.rotations.push_back({pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z});
    b.translations.push_back({pose.translation_m.x, pose.translation_m.y, pose.translation_m.z});
  }
  return b;
}

void take(const Blocks& b, Adjustment& state) {
  state.lens = {b.pinhole[0], b.pinhole[0] * b.pinhole[1], b.pinhole[2], b.pinhole[3], b.distortion};
  state.warp = {b.sag[0], b.sag[1]};
  for (std::size_t i = 0; i < state.poses.size(); ++i) {
    const auto& q = b.rotations[i];
    const auto& t = b.translations[i];
    state.poses[i] = {normalized(Quaternion{q[0], q[1], q[2], q[3]}), {t[0], t[1], t[2]}};
  }
}

// Holds the entries `held` of a block; a block held as a whole becomes a constant.
void hold(ceres::Problem& problem, double* block, int size, const std::vector<int>& held) {
  if (held.empty()) return;
  if (static_cast<int>(held.size()) == size) {
    problem.SetParameterBlockConstant(block);
  } else {
    problem.SetManifold(block, new ceres::SubsetManifold(size, held));
  }
}

std::vector<int> held_distortion(const CalibrationOptions& options) {
  std::vector<int> held;
  const TermSet& fitted = camera_model_info(options.model, "calibration").fitted;
  for (std::size_t i = 0; i < distortion_terms; ++i) {
    if (!fitted.has(i) || options.fixed.contains(std::string(distortion_names[i]))) held.push_back(static_cast<int>(i));
  }
  return held;
}

}  // namespace

std::vector<std::string> fixable_terms() {
  std::vector<std::string> names{"aspect", "principal-point"};
  for (const auto name : distortion_names) names.emplace_back(name);
  return names;
}

void adjust(const std::vector<View>& views, const Board& board, const CalibrationOptions& options, Adjustment& state) {
  Blocks b = blocks_of(state);
  ceres::Problem problem;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    for (const Corner& corner : views[i].corners) {
      auto* cost = new ceres::AutoDiffCostFunction<CornerCost, 2, 4, distortion_terms, 2, 4, 3>(
          new CornerCost{corner.pixel, board.corner_m(corner.id), board.extent(), std::sqrt(state.view_weights[i])});
      problem.AddResidualBlock(cost, new ceres::HuberLoss(state.loss_px), b.pinhole.data(), b.distortion.data(),
                               b.sag.data(), b.rotations[i].data(), b.translations[i].data());
    }
    problem.SetManifold(b.rotations[i].data(), new ceres::QuaternionManifold);
  }
  std::vector<int> held;
  if (options.fixed.contains("aspect")) held.push_back(1);
  if (options.fixed.contains("principal-point")) held.insert(held.end(), {2, 3});
  hold(problem, b.pinhole.data(), 4, held);
  hold(problem, b.distortion.data(), static_cast<int>(distortion_terms), held_distortion(options));
  if (!options.board_warp) problem.SetParameterBlockConstant(b.sag.data());
  problem.SetParameterLowerBound(b.pinhole.data(), 0, 1.0);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.max_num_iterations = most_iterations;
  solver.function_tolerance = 1e-12;
  solver.parameter_tolerance = 1e-11;
  solver.num_threads = 1;  // sums in one order: the same bytes on every machine
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  state.converged = summary.termination_type == ceres::CONVERGENCE;
  take(b, state);
}

std::vector<Vec2> residuals(const View& view, const Board& board, const Adjustment& state, std::size_t index) {
  std::vector<Vec2> result;
  for (const Corner& corner : view.corners) {
    Vec2 pixel{HUGE_VAL, HUGE_VAL};
    predict(state.lens, state.poses[index], board.extent(), state.warp, board.corner_m(corner.id), pixel);
    result.push_back(corner.pixel - pixel);
  }
  return result;
}

}  // namespace gonio::camera
