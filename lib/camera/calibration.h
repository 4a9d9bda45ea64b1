// Calibration of one camera from views of one board: bundle adjustment of the lens, the board's poses and, on request,
// its warp.
//
// Start: focal length from the homographies' vanishing points (Zhang, PAMI 22(11), 2000; OpenCV's initCameraMatrix2D),
// poses from planes (Collins & Bartoli's IPPE, IJCV 109, 2014). Then the sum of squared distances between found and
// predicted corners is minimised by Ceres under Huber's loss at three times the noise, so that single corners cannot
// bend the lens; views that fit much worse than the others are weighted down or dropped. Frames and units:
// board_projection.h. Does not reject a model that fits badly: that is what `complaints` and explain are for.
#pragma once
#include <array>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "camera/board.h"
#include "camera/board_projection.h"
#include "camera/corner_detection.h"
#include "camera/intrinsics.h"

namespace gonio::camera {

struct View {
  std::string name;
  std::vector<Corner> corners;
};

struct CalibrationOptions {
  std::string model = "radial-tangential";  // pinhole | radial-tangential | thin-prism
  std::set<std::string> fixed;              // "aspect", "principal-point", distortion names: held at their start
  bool board_warp = false;                  // free the board's sag
  BoardWarp warp;                           // its start, or what it is held at
  std::optional<Intrinsics> start;          // otherwise found; its distortion is zero
};
// Names that `fixed` may hold.
std::vector<std::string> fixable_terms();

struct CalibratedView {
  BoardPose camera_from_board;
  std::array<double, 6> sigma{};  // rotation vector (rad) and translation (m) as in BoardColumn
  double rms_px = 0;              // sqrt(sum |r|^2 / corners)
  double weight = 0;              // of its squares in the fit; 0: dropped
  std::string note;               // why the weight is not 1
};

struct Calibration {
  Intrinsics lens;
  BoardWarp warp;
  std::vector<std::string> order;  // free parameters: fx_px fy_px cx_px cy_px, distortion names, sag_x_m sag_y_m
  std::vector<double> covariance;  // of `order`, row-major; empty where the views do not determine them
  std::vector<CalibratedView> views;
  double rms_px = 0;               // sqrt(sum |r|^2 / corners) over the corners of views that were kept
  double noise_px = 0;             // estimated sigma of one coordinate
  int corners = 0, set_aside = 0;  // used in rms_px; beyond six sigmas and therefore not
  bool converged = false;
  std::vector<std::string> complaints;  // quality gates that failed, one sentence each

  std::optional<double> sigma(const std::string& name) const;  // of a free parameter
};

Calibration calibrate(const std::vector<View>& views, const Board& board, int width_px, int height_px,
                      const CalibrationOptions& options);

}  // namespace gonio::camera
