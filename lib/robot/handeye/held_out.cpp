#include "robot/handeye/held_out.h"

#include <cmath>

#include "base/parallel.h"
#include "robot/handeye/closed_forms.h"
#include "robot/handeye/reprojection.h"

namespace gonio::robot::handeye {
namespace {

constexpr std::size_t one_at_a_time = 30, folds = 10;

}  // namespace

HeldOutView error_at(const Setup& setup, const View& view, const Solution& solution) {
  const PoseSample sample = sample_of(setup.kind, view.base_from_tool, view.camera_from_board);
  const PoseError e =
      difference(board_seen(sample, solution.mount_from_camera), solution.stand_from_board, setup.middle_m());
  return {rms_px(setup, view, predicted_pose(setup.kind, view, solution)), e.translation_m, e.rotation_rad};
}

HeldOutView root_mean_square(const std::vector<HeldOutView>& views) {
  HeldOutView sum;
  for (const HeldOutView& v : views) {
    sum.rms_px += v.rms_px * v.rms_px;
    sum.translation_m += v.translation_m * v.translation_m;
    sum.rotation_rad += v.rotation_rad * v.rotation_rad;
  }
  const double n = views.empty() ? 1 : static_cast<double>(views.size());
  return {std::sqrt(sum.rms_px / n), std::sqrt(sum.translation_m / n), std::sqrt(sum.rotation_rad / n)};
}

HeldOutErrors held_out(const Setup& setup, const std::vector<View>& views, const std::string& method) {
  const std::size_t parts = views.size() <= one_at_a_time ? views.size() : folds;
  HeldOutErrors result{method, std::vector<HeldOutView>(views.size()), {}};
  parallel_for(0, parts, [&](std::size_t part) {
    std::vector<View> seen;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (i % parts != part) seen.push_back(views[i]);
    }
    const std::vector<PoseSample> samples = samples_of(setup, seen);
    const bool refined = method == "joint" || method == "reprojection";
    Solution solution = closed_form(refined ? "park" : method, "held_out").solve(samples);
    if (method == "reprojection") solution = minimise_reprojection(setup, seen, solution);
    if (method == "joint") solution = refine(setup, seen, std::vector<bool>(seen.size(), true), solution).solution;
    for (std::size_t i = part; i < views.size(); i += parts) result.views[i] = error_at(setup, views[i], solution);
  });
  result.rms = root_mean_square(result.views);
  return result;
}

}  // namespace gonio::robot::handeye
