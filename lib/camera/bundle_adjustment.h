// The steps of calibrate(): a start, the adjustment, and the covariance of its result. For sources of this folder only.
//
// The adjustment is Levenberg and Marquardt's on the normal equations, poses eliminated by their Schur complement
// (Brown 1976; Triggs et al., "Bundle adjustment: a modern synthesis", 2000, section 6), with iteratively reweighted
// squares for Huber's loss. Sums run in the order of the views: the same bytes on every machine.
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "camera/calibration.h"

namespace gonio::camera {

using CameraFromRig = Rigid<frame::Camera, frame::Rig>;

// What the adjustment moves, and the weights it works under.
struct Adjustment {
  std::vector<Intrinsics> lenses;
  std::vector<CameraFromRig> camera_from_rig;
  std::vector<bool> tied;  // camera_from_rig moves
  std::vector<BoardWarp> warps;
  std::vector<PlacedBoard> placements;
  std::vector<std::size_t> placement_of;       // per view
  std::vector<double> view_weights;            // per view; 0: left out
  std::vector<std::vector<double>> precision;  // per view and corner: inverse variance relative to the usual one
  double loss_px = 2;                          // where Huber's loss turns linear, of a view of precision 1
  bool converged = false;

  BoardPose pose(const View& view, std::size_t index) const {
    return camera_from_rig[view.camera] * placements[placement_of[index]];
  }
};

// A free parameter as a direction in the columns of BoardColumn (two of them where the aspect ratio is held); of a rig
// parameter the column counts from 0 to 5.
struct FreeParameter {
  SharedParameter what;
  std::vector<std::pair<std::size_t, double>> columns;
};
// `all_warps`: also of boards whose warp is held.
std::vector<FreeParameter> free_parameters(const CalibrationSetup& setup, const Adjustment& state,
                                           bool all_warps = false);

// [A B; B' C] (shared; placements) of J' W J, and J' W r.
struct NormalEquations {
  Eigen::MatrixXd a;
  Eigen::VectorXd g;
  std::vector<Eigen::MatrixXd> b;              // shared x 6, per placement
  std::vector<Eigen::Matrix<double, 6, 6>> c;  // zero where no view has a weight
  std::vector<Eigen::Matrix<double, 6, 1>> h;
  double cost = 0;         // under the loss
  double squares = 0;      // weighted sum of squared residuals
  double coordinates = 0;  // how many were summed, weights below one counted as such
};
NormalEquations normal_equations(const std::vector<View>& views, const CalibrationSetup& setup,
                                 const std::vector<FreeParameter>& free, const Adjustment& state);

// The shared part with the placements eliminated: A - sum B C^-1 B'.
Eigen::MatrixXd schur_complement(const NormalEquations& n);

Intrinsics start_lens(const std::vector<View>& views, const std::vector<BoardSetup>& boards, const CameraSetup& camera);
// Every camera's lens and views by themselves, then the rig. `state` has placement_of, view_weights and precision.
void start(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state);

void adjust(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state);

// Found minus predicted, per corner.
std::vector<Vec2> residuals(const View& view, const CalibrationSetup& setup, const Adjustment& state,
                            std::size_t index);

// Fills shared, covariance, noise_px, placements and the sigmas of cameras, boards and views of `result`.
void estimate_covariance(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
                         Calibration& result);

// Fills `complaints`: calibration_judgement.cpp.
void judge(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state, Calibration& result);

}  // namespace gonio::camera
