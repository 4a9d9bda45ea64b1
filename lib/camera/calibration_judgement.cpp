// What a calibration must pass before it is trusted: enough views, a fit that converged and that fits, a focal length
// that the views determine, by the noise and by the shape of the board.
//
// A board that is not flat moves the focal length, the more the more frontal the views are. Both of its effects follow
// from the normal equations with the sags w of all boards as further parameters, placements eliminated,
//
//   [S_l  S_lw; S_lw' S_w] (dl, dw) = (g_l, g_w):
//
// a sag w that the fit leaves out moves the lens by S_l^-1 S_lw w, at a thousandth of the board's side (what the
// flattest boards on sale promise) and at right angles to the noise; and the solution (dl, dw) is what freeing the sag
// would do, because the residuals of this very fit say that the board is bent.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "camera/bundle_adjustment.h"
#include "linear/solve.h"

namespace gonio::camera {
namespace {

using Kind = SharedParameter::Kind;
using Matrix = Eigen::MatrixXd;

constexpr std::size_t least_views = 3;
constexpr double noise_limit = 0.02;    // sigma over focal length
constexpr double doubt_limit = 0.01;    // change over focal length by noise and sag together
constexpr double usual_sag = 1e-3;      // of the board's side
constexpr double significant = 12;      // chi-square of two sags over two: one false alarm in 160000
constexpr double telling_share = 0.25;  // of the squared residuals, for the board to be to blame
constexpr double worth_saying = 1e-3;
constexpr double rms_limit_px = 3;

// Changes of the shared parameters that are free, in their order.
struct SagEffects {
  Matrix usual;             // a column for every held sag at its usual size
  Eigen::VectorXd freed;    // by freeing the held sags
  double sag_m = 0;         // that freeing them would find, of the worst board, peak to valley
  double significance = 0;  // chi-square of freeing them over its degrees of freedom
  double share = 0;         // of the squared residuals that it would explain; little where something else misfits
};

SagEffects sag_effects(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
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
  const NormalEquations n = normal_equations(views, setup, all, state);
  const Matrix s = schur_complement(n);
  Eigen::VectorXd g = n.g;
  for (std::size_t p = 0; p < n.c.size(); ++p) {
    if (n.c[p](0, 0) > 0) g -= n.b[p] * linear::solve_ldlt(n.c[p], n.h[p]);
  }
  const Matrix cross = s(free, held);
  SagEffects effects;
  effects.usual = linear::solve_ldlt(s(free, free), cross) *
                  Eigen::Map<const Eigen::VectorXd>(size.data(), cross.cols()).asDiagonal();
  const Eigen::VectorXd scale = n.a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Matrix scaled = scale.asDiagonal() * s * scale.asDiagonal();
  const Eigen::VectorXd change = scale.asDiagonal() * linear::solve_ldlt(scaled, scale.asDiagonal() * g);
  effects.freed = change(free);
  effects.significance =
      change.dot(g) / std::max(1e-300, result.noise_px * result.noise_px) / static_cast<double>(held.size());
  effects.share = n.squares > 0 ? change.dot(g) / n.squares : 0;
  std::vector<double> sags(setup.boards.size());
  for (const Eigen::Index i : held) {
    double& own = sags[all[static_cast<std::size_t>(i)].what.of];
    own += std::abs(change(i));
    effects.sag_m = std::max(effects.sag_m, own);
  }
  return effects;
}

// Angle between a view's board and the image plane.
double tilt(const BoardPose& pose) {
  return std::acos(std::min(1.0, std::abs(pose.rotate({0, 0, 1}).z)));
}

struct Focal {  // relative changes of a focal length
  double noise = 0, usual_sag = 0, freed_sag = 0;
  double doubt() const { return std::hypot(noise, usual_sag); }
};

Focal focal_changes(const Calibration& result, const SagEffects& effects, std::size_t camera) {
  Focal worst;
  for (const std::size_t p : result.lens_parameters(camera)) {
    const std::string& name = result.shared[p].name;
    if (name != "fx_px" && name != "fy_px") continue;
    const Intrinsics& lens = result.cameras[camera].lens;
    const double f = name == "fx_px" ? lens.fx_px : lens.fy_px;
    const auto row = static_cast<Eigen::Index>(p);
    // Of the corners' noise alone: what a wrong lens adds is no fault of the views.
    const double noise = result.sigma(name, camera).value_or(0) / std::sqrt(std::max(1.0, result.excess));
    worst.noise = std::max(worst.noise, noise / f);
    if (effects.usual.size() == 0) continue;
    worst.usual_sag = std::max(worst.usual_sag, effects.usual.row(row).norm() / f);
    worst.freed_sag = std::max(worst.freed_sag, std::abs(effects.freed(row)) / f);
  }
  return worst;
}

// Tilt that half of a camera's views stay below, in degrees.
double usual_tilt(const std::vector<View>& views, std::size_t camera, const Calibration& result) {
  std::vector<double> tilts;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].camera == camera && result.views[i].weight > 0)
      tilts.push_back(tilt(result.views[i].camera_from_board));
  }
  std::ranges::sort(tilts);
  return tilts.empty() ? 0 : tilts[tilts.size() / 2] * 180 / pi;
}

void judge_focal(const std::vector<View>& views, std::size_t camera, const std::string& name, const SagEffects& effects,
                 Calibration& result) {
  const Focal focal = focal_changes(result, effects, camera);
  result.cameras[camera].focal_doubt = focal.doubt();
  const double tilted = usual_tilt(views, camera, result);
  const std::string frontal = format(
      "the views are too frontal or too few (half of them tilt the board by less than "
      "%.0f degrees)",
      tilted);
  const std::string remedy = "tilt the board by 20 to 45 degrees about both axes, or hold a focal length that is known";
  const bool bent = effects.significance > significant && effects.share > telling_share;
  if (focal.noise > noise_limit) {
    result.complaints.push_back(
        name +
        format("the focal length is known to %.1f %% only (limit %.0f %%): ", 100 * focal.noise, 100 * noise_limit) +
        frontal + "; " + remedy);
  } else if (focal.doubt() > doubt_limit) {
    result.complaints.push_back(name +
                                format("the focal length cannot be trusted: it would change by %.1f %% (limit %.0f %%) "
                                       "if the board bulged by a thousandth of its side, because ",
                                       100 * focal.doubt(), 100 * doubt_limit) +
                                frontal + "; " + remedy);
  } else if (!bent) {
    return;
  } else if (focal.freed_sag > doubt_limit) {
    result.complaints.push_back(
        name +
        format("the focal length cannot be trusted: the corners say that the board is not flat but bulges by about "
               "%.1f mm, which alone changes it by about %.1f %% (limit %.0f %%) in views that tilt the board by %.0f "
               "degrees",
               1e3 * effects.sag_m, 100 * focal.freed_sag, 100 * doubt_limit, tilted) +
        "; fix the board to glass, or fit its shape with --board-warp and " + remedy);
  } else if (focal.freed_sag > worth_saying) {
    result.advice.push_back(name + format("the corners say that the board bulges by about %.2f mm; --board-warp would "
                                          "change the focal length by %.2f %%",
                                          1e3 * effects.sag_m, 100 * focal.freed_sag));
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
  const SagEffects effects = sag_effects(views, setup, state, result);
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) {
    const std::string name = setup.cameras.size() > 1 ? setup.cameras[c].name + ": " : "";
    judge_focal(views, c, name, effects, result);
  }
}

}  // namespace gonio::camera
