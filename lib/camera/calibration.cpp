// The course of a calibration: start, adjust, weigh the views, judge.
#include "camera/calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "camera/bundle_adjustment.h"

namespace gonio::camera {
namespace {

constexpr std::size_t least_corners = 6;  // in a view: a pose and something to check it with
constexpr double first_loss_px = 2;       // before the noise is known
constexpr double least_loss_px = 0.02;
constexpr double loss_sigmas = 3;
constexpr double set_aside_sigmas = 6;
constexpr double suspicious = 2.5, hopeless = 6;  // noise of a view over the median of all
constexpr int weighing_rounds = 4;
constexpr std::size_t least_views = 3;
constexpr double focal_limit = 0.02;  // sigma over focal length
constexpr double rms_limit_px = 3;

std::string format(const char* pattern, double a, double b = 0) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, a, b);
  return text;
}

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

bool spans_a_plane(const View& view, const Board& board) {  // corners on one line allow no pose
  std::set<int> columns, rows;
  for (const Corner& c : view.corners) {
    columns.insert(c.id % board.corner_columns);
    rows.insert(c.id / board.corner_columns);
  }
  return columns.size() >= 2 && rows.size() >= 2;
}

// Sigma of one coordinate from the median distance, for which |r|^2 = 2 ln 2 s^2 in two dimensions.
double robust_noise(const std::vector<Vec2>& residual) {
  std::vector<double> sizes;
  for (const Vec2 r : residual) sizes.push_back(norm(r));
  return median(sizes) / std::sqrt(2 * std::log(2.0));
}

double robust_noise(const std::vector<View>& views, const Board& board, const Adjustment& state) {
  std::vector<Vec2> all;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    const std::vector<Vec2> residual = residuals(views[i], board, state, i);
    all.insert(all.end(), residual.begin(), residual.end());
  }
  return robust_noise(all);
}

double rms(const std::vector<Vec2>& residual) {
  double sum = 0;
  for (const Vec2 r : residual) sum += dot(r, r);
  return residual.empty() ? 0 : std::sqrt(sum / static_cast<double>(residual.size()));
}

// Weights from how much worse a view fits than the median one, single bad corners apart; true where they changed.
bool weigh_views(const std::vector<View>& views, const Board& board, Adjustment& state, Calibration& result) {
  std::vector<double> all(views.size()), used;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    all[i] = robust_noise(residuals(views[i], board, state, i));
    used.push_back(all[i]);
  }
  if (used.size() < 2 * least_views) return false;  // too few to call one of them the odd one out
  const double usual = median(used);
  bool changed = false;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    const double ratio = all[i] / usual;
    const double weight = ratio > hopeless ? 0 : ratio > suspicious ? 1 / (ratio * ratio) : 1;
    changed |= std::abs(weight - state.view_weights[i]) > 0.05;
    state.view_weights[i] = weight;
    result.views[i].note = weight == 1
                               ? ""
                               : format("its corners scatter by %.2f px, the median view's by %.2f px", all[i], usual) +
                                     (weight == 0 ? "; dropped" : "; weighted down");
  }
  return changed;
}

// Poses that fit better from the other solution of the plane, now that the lens is known.
bool try_other_poses(const std::vector<View>& views, const Board& board, Adjustment& state) {
  bool changed = false;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    const double now = rms(residuals(views[i], board, state, i));
    Adjustment other = state;
    other.poses[i] = start_pose(views[i], board, state.lens);
    if (rms(residuals(views[i], board, other, i)) >= 0.9 * now) continue;
    state.poses[i] = other.poses[i];
    changed = true;
  }
  return changed;
}

void summarise(const std::vector<View>& views, const Board& board, const Adjustment& state, Calibration& result) {
  result.lens = state.lens;
  result.warp = state.warp;
  result.converged = state.converged;
  const double limit = set_aside_sigmas * std::max(robust_noise(views, board, state), 1e-6);
  double sum = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    CalibratedView& view = result.views[i];
    view.camera_from_board = state.poses[i];
    view.weight = state.view_weights[i];
    if (views[i].corners.size() < least_corners) continue;
    std::vector<Vec2> kept = residuals(views[i], board, state, i);
    if (view.weight > 0) {
      result.set_aside +=
          static_cast<int>(std::erase_if(kept, [&](Vec2 r) { return std::sqrt(view.weight) * norm(r) > limit; }));
      result.corners += static_cast<int>(kept.size());
      for (const Vec2 r : kept) sum += dot(r, r);
    }
    view.rms_px = rms(kept);
  }
  result.rms_px = result.corners > 0 ? std::sqrt(sum / result.corners) : 0;
}

void judge(Calibration& result) {
  const auto used = static_cast<std::size_t>(
      std::ranges::count_if(result.views, [](const CalibratedView& v) { return v.weight > 0; }));
  if (used < least_views) {
    result.complaints.push_back(std::to_string(used) + (used == 1 ? " view shows" : " views show") +
                                " the board (at least 3 are needed); photograph it from more directions");
  }
  if (!result.converged) {
    result.complaints.push_back("the adjustment did not converge; look at the views with the largest rms_px");
  }
  if (result.rms_px > rms_limit_px) {
    result.complaints.push_back(format("corners miss by %.1f px (limit %.0f px)", result.rms_px, rms_limit_px) +
                                "; check the board's size, its layout and the lens model");
  }
  if (result.covariance.empty()) {
    result.complaints.push_back(
        "the views do not determine the camera (singular normal equations); tilt the board by 20 to 45 degrees about "
        "both axes");
    return;
  }
  const double share = std::max(result.sigma("fx_px").value_or(0) / result.lens.fx_px,
                                result.sigma("fy_px").value_or(0) / result.lens.fy_px);
  if (share > focal_limit) {
    result.complaints.push_back(
        format("the focal length is known to %.1f %% only (limit %.0f %%)", 100 * share, 100 * focal_limit) +
        ": the views are too frontal or too few; tilt the board by 20 to 45 degrees about both axes");
  }
}

}  // namespace

std::optional<double> Calibration::sigma(const std::string& name) const {
  const auto found = std::ranges::find(order, name);
  if (found == order.end() || covariance.empty()) return std::nullopt;
  const auto i = static_cast<std::size_t>(found - order.begin());
  return std::sqrt(covariance[i * order.size() + i]);
}

Calibration calibrate(const std::vector<View>& views, const Board& board, int width_px, int height_px,
                      const CalibrationOptions& options) {
  Calibration result;
  result.views.resize(views.size());
  Adjustment state;
  state.poses.resize(views.size(), BoardPose{{}, {0, 0, 1}});
  state.view_weights.resize(views.size());
  std::vector<View> usable;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const bool enough = views[i].corners.size() >= least_corners && spans_a_plane(views[i], board);
    state.view_weights[i] = enough ? 1 : 0;
    if (enough)
      usable.push_back(views[i]);
    else
      result.views[i].note = "too few corners (" + std::to_string(views[i].corners.size()) + ")";
  }
  if (usable.empty()) {
    result.complaints.push_back("no view shows enough corners of the board");
    return result;
  }
  state.lens = options.start ? *options.start : start_lens(usable, board, options.model, width_px, height_px);
  if (options.fixed.contains("aspect") && !options.start) state.lens.fy_px = state.lens.fx_px;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] > 0) state.poses[i] = start_pose(views[i], board, state.lens);
  }
  state.warp = options.warp;
  state.loss_px = first_loss_px;
  adjust(views, board, options, state);
  if (try_other_poses(views, board, state)) adjust(views, board, options, state);
  for (int round = 0; round < weighing_rounds; ++round) {
    const bool changed = weigh_views(views, board, state, result);
    state.loss_px = std::max(least_loss_px, loss_sigmas * robust_noise(views, board, state));
    adjust(views, board, options, state);
    if (!changed && round > 0) break;
  }
  summarise(views, board, state, result);
  estimate_covariance(views, board, options, state, result);
  judge(result);
  return result;
}

}  // namespace gonio::camera
