// The steps of calibrate(): a start, the adjustment, and the covariance of its result. For sources of this folder only.
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "camera/calibration.h"

namespace gonio::camera {

// What the adjustment moves, and the weights it works under.
struct Adjustment {
  Intrinsics lens;
  BoardWarp warp;
  std::vector<BoardPose> poses;      // one per view
  std::vector<double> view_weights;  // one per view; 0: left out
  double loss_px = 2;                // where Huber's loss turns linear
  bool converged = false;
};

Intrinsics start_lens(const std::vector<View>& views, const Board& board, const std::string& model, int width_px,
                      int height_px);
// The better one of the two poses that a plane allows.
BoardPose start_pose(const View& view, const Board& board, const Intrinsics& lens);

void adjust(const std::vector<View>& views, const Board& board, const CalibrationOptions& options, Adjustment& state);

// Found minus predicted, per corner.
std::vector<Vec2> residuals(const View& view, const Board& board, const Adjustment& state, std::size_t index);

// A free parameter as a direction in the columns of BoardColumn (two of them where the aspect ratio is held).
struct FreeParameter {
  std::string name;
  std::vector<std::pair<std::size_t, double>> columns;
};
std::vector<FreeParameter> free_parameters(const CalibrationOptions& options, const Intrinsics& lens);

// Fills order, noise_px, covariance and the views' sigma of `result` from the normal equations at `state`.
void estimate_covariance(const std::vector<View>& views, const Board& board, const CalibrationOptions& options,
                         const Adjustment& state, Calibration& result);

}  // namespace gonio::camera
