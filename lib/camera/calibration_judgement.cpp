// What a calibration must pass before it is trusted: enough views, a fit that converged and that fits, a focal length
// that the views determine, by the noise and by what a board that is not quite flat would do to it.
//
// The latter from the normal equations: with the sag w of the board as one more parameter, held at zero, the Schur
// complement over the placements is [S_l  S_lw; S_lw' S_w], and a true sag w moves the fitted lens by S_l^-1 S_lw w. A
// sag of a thousandth of the side is what the flattest boards on sale promise; paper on a table has several times that.
// Near-frontal views hold focal length apart from distance by little, so that the same sag moves it by percents.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "camera/bundle_adjustment.h"

namespace gonio::camera {
namespace {

using Kind = SharedParameter::Kind;
using Matrix = Eigen::MatrixXd;

constexpr std::size_t least_views = 3;
constexpr double noise_limit = 0.02;  // sigma over focal length
constexpr double doubt_limit = 0.01;  // change over focal length by noise and sag together
constexpr double usual_sag = 1e-3;    // of the board's side
constexpr double rms_limit_px = 3;

std::string format(const char* pattern, double a, double b = 0, double c = 0, double d = 0) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, a, b, c, d);
  return text;
}

// Change of the shared parameters that are free (rows) for every held sag (columns) at its usual size; empty where the
// views do not determine them.
Matrix changes_by_sag(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
                      const Calibration& result) {
  const std::vector<FreeParameter> all = free_parameters(setup, state, true);
  std::vector<Eigen::Index> free, held;
  std::vector<double> size;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::ranges::find(result.shared, all[i].what) != result.shared.end()) {
      free.push_back(static_cast<Eigen::Index>(i));
      continue;
    }
    held.push_back(static_cast<Eigen::Index>(i));
    const Vec2 half = setup.boards[all[i].what.of].board.extent().half_m;
    size.push_back(2 * usual_sag * (all[i].what.name == "sag_x_m" ? half.x : half.y));
  }
  if (free.empty() || held.empty()) return {};
  const Matrix s = schur_complement(normal_equations(views, setup, all, state));
  const Matrix cross = s(free, held);
  return s(free, free).ldlt().solve(cross) * Eigen::Map<const Eigen::VectorXd>(size.data(), cross.cols()).asDiagonal();
}

// Angle between a view's board and the image plane.
double tilt(const BoardPose& pose) {
  return std::acos(std::min(1.0, std::abs(pose.rotate({0, 0, 1}).z)));
}

struct Focal {
  double noise = 0, sag = 0;  // relative changes
  double doubt() const { return std::hypot(noise, sag); }
};

Focal focal_doubt(const Calibration& result, const Matrix& by_sag, std::size_t camera) {
  Focal worst;
  for (const std::size_t p : result.lens_parameters(camera)) {
    const std::string& name = result.shared[p].name;
    if (name != "fx_px" && name != "fy_px") continue;
    const Intrinsics& lens = result.cameras[camera].lens;
    const double f = name == "fx_px" ? lens.fx_px : lens.fy_px;
    const Focal own{result.sigma(name, camera).value_or(0) / f,
                    by_sag.size() > 0 ? by_sag.row(static_cast<Eigen::Index>(p)).norm() / f : 0};
    if (own.doubt() > worst.doubt()) worst = own;
  }
  return worst;
}

void judge_focal(const std::vector<View>& views, std::size_t camera, const std::string& name, const Matrix& by_sag,
                 Calibration& result) {
  const Focal focal = focal_doubt(result, by_sag, camera);
  result.cameras[camera].focal_doubt = focal.doubt();
  std::vector<double> tilts;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].camera == camera && result.views[i].weight > 0)
      tilts.push_back(tilt(result.views[i].camera_from_board));
  }
  std::ranges::sort(tilts);
  const std::string remedy =
      "; tilt the board by 20 to 45 degrees about both axes, or hold a focal length that is known";
  if (focal.noise > noise_limit) {
    result.complaints.push_back(
        name +
        format("the focal length is known to %.1f %% only (limit %.0f %%)", 100 * focal.noise, 100 * noise_limit) +
        ": the views are too frontal or too few" + remedy);
  } else if (focal.doubt() > doubt_limit) {
    const double middle = tilts.empty() ? 0 : tilts[tilts.size() / 2] * 180 / pi;
    result.complaints.push_back(
        name +
        format(
            "the focal length cannot be trusted: it would change by %.1f %% (limit %.0f %%) if the board bulged by a "
            "thousandth of its side, because the views are too frontal (half of them tilt the board by less than "
            "%.0f degrees)",
            100 * focal.doubt(), 100 * doubt_limit, middle) +
        remedy);
  }
}

void judge_camera(const std::vector<View>& views, const CameraSetup& setup, std::size_t camera, Calibration& result) {
  const std::string name = result.cameras.size() > 1 ? setup.name + ": " : "";
  std::size_t used = 0;
  for (std::size_t i = 0; i < views.size(); ++i) used += views[i].camera == camera && result.views[i].weight > 0;
  const std::size_t needed = setup.fixed.contains("intrinsics") ? 1 : least_views;
  if (used < needed) {
    result.complaints.push_back(name + std::to_string(used) + (used == 1 ? " view shows" : " views show") +
                                " the board (at least " + std::to_string(needed) +
                                " are needed); photograph it from more directions");
  }
  if (result.cameras[camera].rms_px > rms_limit_px) {
    result.complaints.push_back(
        name + format("corners miss by %.1f px (limit %.0f px)", result.cameras[camera].rms_px, rms_limit_px) +
        "; check the board's size, its layout and the lens model");
  }
}

}  // namespace

void judge(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
           Calibration& result) {
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) judge_camera(views, setup.cameras[c], c, result);
  if (!result.converged) {
    result.complaints.push_back("the adjustment did not converge; look at the views with the largest rms_px");
  }
  if (result.shared.empty()) return;
  if (result.covariance.empty()) {
    result.complaints.push_back(
        "the views do not determine the camera (singular normal equations); tilt the board by 20 to 45 degrees about "
        "both axes");
    return;
  }
  const Matrix by_sag = changes_by_sag(views, setup, state, result);
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) {
    const std::string name = setup.cameras.size() > 1 ? setup.cameras[c].name + ": " : "";
    judge_focal(views, c, name, by_sag, result);
  }
}

}  // namespace gonio::camera
