// See compensation.h.
#include "inference/compensation.h"

#include <cmath>

#include "inference/wording.h"

namespace gonio::inference {

void compare_with_calibration(const Problem& problem, Explanation& e) {
  for (Compensation& c : e.compensation) {
    const std::optional<Calibration> stated = problem.calibration(c.parameter);
    if (!stated) continue;
    c.calibrated = stated->value;
    c.calibrated_sigma = stated->sigma;
    c.towards = std::abs(c.after - stated->value) < std::abs(c.before - stated->value);
  }
}

std::string compensation_in_words(const Problem& problem, const Explanation& e) {
  if (e.compensation.empty()) return "";
  const Compensation& most = e.compensation[0];
  const double moved = most.sigma > 0 ? std::abs(most.after - most.before) / most.sigma : 0;
  std::string text;
  if (moved >= 2) {
    const Parameter& p = problem.parameters()[most.parameter];
    const Shown shown = shown_in(p.unit, most.after);
    const std::string unit = shown.unit.empty() ? "" : " " + shown.unit;
    text = p.name + " moved from " + printed(most.before * shown.factor, 5) + " to " +
           printed(most.after * shown.factor, 5) + unit + ", by " + plain_number(moved) + " of its standard errors.";
  }
  std::size_t calibrated = 0, towards = 0;
  for (const Compensation& c : e.compensation) {
    if (!c.calibrated || !(std::abs(c.after - c.before) >= 0.5 * c.sigma)) continue;
    ++calibrated;
    towards += c.towards;
  }
  if (calibrated > 0)
    text += (text.empty() ? "" : " ") + std::string("Of ") + std::to_string(calibrated) +
            " parameters with an independent calibration that moved, " + std::to_string(towards) + " moved towards it.";
  return text;
}

}  // namespace gonio::inference
