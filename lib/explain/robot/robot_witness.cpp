// See robot_witness.h.
#include "explain/robot/robot_witness.h"

#include <algorithm>
#include <cmath>

#include "manifest/document.h"
#include "robot/chain/input.h"
#include "robot/handeye/closed_forms.h"

namespace gonio::explain {
namespace {

using robot::ChainInput;
using robot::handeye::PoseError;

// Of every view: the board's place by this view against its place by all.
std::vector<PoseError> deviations(const ChainInput& input) {
  using namespace robot::handeye;
  const Kind kind = input.eye_to_hand ? Kind::eye_to_hand : Kind::eye_in_hand;
  std::vector<PoseSample> samples;
  for (const ChainInput::View& view : input.views)
    samples.push_back(sample_of(kind, view.base_from_tool, view.camera_from_board));
  const Solution solution = closed_form("park", input.mounting).solve(samples);
  std::vector<PoseError> errors;
  for (const PoseSample& sample : samples)
    errors.push_back(difference(board_seen(sample, solution.mount_from_camera), solution.stand_from_board,
                                {input.extent.middle_m.x, input.extent.middle_m.y, 0}));
  return errors;
}

Testimony compared(const std::vector<PoseError>& before, const std::vector<PoseError>& after, double PoseError::*part,
                   Testimony t) {
  const auto n = static_cast<double>(before.size());
  double sum_before = 0, sum_after = 0, squares = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    const double a = before[v].*part * (before[v].*part), b = after[v].*part * (after[v].*part);
    sum_before += a, sum_after += b, squares += (b - a) * (b - a);
  }
  const double mean = (sum_after - sum_before) / n, variance = std::max(0.0, squares / n - mean * mean) / (n - 1);
  t.before = std::sqrt(sum_before / n), t.after = std::sqrt(sum_after / n);
  t.errors = variance > 0 ? mean / std::sqrt(variance) : 0;
  return t;
}

}  // namespace

std::vector<Testimony> hand_eye_testimony(const manifest::Document& stated, const manifest::Document& mended) {
  const std::vector<ChainInput> before = robot::robot_inputs(stated), after = robot::robot_inputs(mended);
  std::vector<Testimony> told;
  for (std::size_t k = 0; k < std::min(before.size(), after.size()); ++k) {
    if (before[k].mounting != after[k].mounting || before[k].views.size() != after[k].views.size()) continue;
    const std::vector<PoseError> a = deviations(before[k]), b = deviations(after[k]);
    const std::string by = "the arm of " + before[k].mounting;
    told.push_back(compared(a, b, &PoseError::rotation_rad, {by, "turn of the board between its poses", "rad"}));
    told.push_back(compared(a, b, &PoseError::translation_m, {by, "shift of the board between its poses", "m"}));
  }
  return told;
}

}  // namespace gonio::explain
