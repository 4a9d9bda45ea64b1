// Calibration of one or several cameras from views of one or several boards: bundle adjustment of the lenses, of how
// the cameras of a rig stand to each other, of the boards' poses and, on request, of their warp.
//
// A view is one board in one image. Images that the cameras of a rig take at the same moment are one shot; a board in a
// shot stands at one place, the placement, which all views of it share:
//
//   camera_from_board(view) = camera_from_rig(camera) rig_from_board(placement).
//
// The first of the cameras that share shots defines the rig's frame. A single camera with one board is the case in
// which every view is a shot of its own.
//
// Start: focal length from the homographies' vanishing points (Zhang, PAMI 22(11), 2000; OpenCV's initCameraMatrix2D),
// poses from planes (Collins & Bartoli's IPPE, IJCV 109, 2014), every camera by itself; then the rig by the motion that
// most shots agree on. The weighted sum of squared distances between found and predicted corners is minimised under
// Huber's loss at three times the noise (bundle_adjustment.h), so that single corners cannot bend the lens; views count
// with the inverse variance of their corners, and views that fit much worse than the others are weighted down or
// dropped. Frames and units: board_projection.h. Does not reject a model that fits badly: that is what `complaints` and
// explain are for.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "camera/board.h"
#include "camera/board_projection.h"
#include "camera/corner_detection.h"
#include "camera/intrinsics.h"

namespace gonio::camera {

using RigPose = Rigid<frame::Rig, frame::Camera>;
using PlacedBoard = Rigid<frame::Rig, frame::Board>;

struct View {  // one board in one image
  std::string name{};
  std::vector<Corner> corners{};
  double noise_px = 0;                // of one coordinate as measured in the picture; 0: not known
  std::size_t camera = 0, board = 0;  // places in the setup
  std::size_t shot = 0;               // equal in images taken at the same moment
};

struct CameraSetup {  // what is known of a camera, and what may move
  std::string name = "camera";
  int width_px = 0, height_px = 0;
  std::string model = "radial-tangential";  // one of calibrated_models()
  std::set<std::string> fixed{};            // fixable_terms(): held at the start
  std::optional<Intrinsics> start{};        // otherwise found; its distortion is the model's neutral one
};
struct BoardSetup {
  std::string name = "board";
  Board board;
  bool free_warp = false;  // free the board's sag
  BoardWarp warp;          // its start, or what it is held at
};
struct CalibrationSetup {
  std::vector<CameraSetup> cameras;
  std::vector<BoardSetup> boards;
};
// Names that `fixed` may hold: intrinsics (all of them), distortion, aspect, principal-point, and single terms.
std::vector<std::string> fixable_terms();

// What several views have in common. `of` counts cameras or boards; rig parameters are a change of camera_from_rig in
// the sense of BoardColumn (rotation vector on the left in the camera's axes, then shift).
struct SharedParameter {
  enum class Kind { lens, rig, board } kind = Kind::lens;
  std::size_t of = 0;
  std::string name;  // fx_px fy_px cx_px cy_px, distortion names; rotation_x_rad .. translation_z_m; sag_x_m sag_y_m
  bool operator==(const SharedParameter&) const = default;
};

struct CalibratedCamera {
  Intrinsics lens;
  RigPose rig_from_camera;
  std::array<double, 6>
      rig_sigma{};      // rotation vector (rad) on the left in the rig's axes, translation (m); 0: defines it
  bool tied = false;    // to others, by shots in common
  double rms_px = 0;    // sqrt(sum |r|^2 / corners) over the corners of views that were kept
  double noise_px = 0;  // estimated sigma of one coordinate
  int corners = 0, set_aside = 0;  // used in rms_px; beyond six sigmas and therefore not
  double focal_doubt = 0;          // relative change of the focal length by noise and a usual sag of the board
};
struct CalibratedBoard {
  BoardWarp warp;
  std::optional<double> flatness_m, flatness_sigma_m;  // peak to valley over the corners, where the warp was fitted
};
// A board in a shot. The pose follows the shared parameters: to first order a change d of these moves it by `slope` d,
// and its covariance is own + slope covariance slope'.
struct Placement {
  std::size_t shot = 0, board = 0;
  PlacedBoard rig_from_board;
  std::vector<double> slope;     // 6 x shared, row-major: -C^-1 B' of the normal equations [A B; B' C]
  std::array<double, 36> own{};  // covariance at given shared parameters: noise^2 C^-1
};
struct CalibratedView {
  std::size_t placement = 0;
  BoardPose camera_from_board;
  std::array<double, 6> sigma{};       // rotation vector (rad) and translation (m) as in BoardColumn
  double rms_px = 0;                   // sqrt(sum |r|^2 / corners)
  double weight = 0;                   // of its squares in the fit, beside its noise; 0: dropped
  double sigma_px = 0;                 // of one coordinate, that the fit counted with
  std::vector<Vec2> residuals;         // found minus predicted, per corner
  std::vector<double> corner_weights;  // 1, less where the loss holds a corner back
  std::string note;                    // why the weight is not 1
};

struct Calibration {
  std::vector<CalibratedCamera> cameras;
  std::vector<CalibratedBoard> boards;
  std::vector<Placement> placements;
  std::vector<CalibratedView> views;
  std::vector<SharedParameter> shared;
  std::vector<double> covariance;   // of `shared`, row-major; empty where the views do not determine them
  double rms_px = 0, noise_px = 0;  // over all cameras; noise: of unit weight
  double excess = 1;  // variance between shots over what corners' noise explains; `covariance` is widened by it above 1
  bool converged = false;
  std::vector<std::string> complaints;  // quality gates that failed, one sentence each
  std::vector<std::string> advice;      // what would make it better, one sentence each

  std::optional<double> sigma(const std::string& name, std::size_t of = 0) const;  // of a free parameter
  std::vector<std::size_t> lens_parameters(std::size_t camera) const;              // places in `shared`
};

Calibration calibrate(const std::vector<View>& views, const CalibrationSetup& setup);

// The better one of the two poses that a plane allows, under a lens that is known (calibration_start.cpp).
BoardPose start_pose(const View& view, const Board& board, const Intrinsics& lens);

}  // namespace gonio::camera
