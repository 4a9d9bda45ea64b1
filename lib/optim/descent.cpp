// See descent.h.
#include "optim/descent.h"

#include <algorithm>
#include <string_view>

namespace gonio::optim {
namespace {

constexpr double most_relief = 0.1;  // damping falls by no more at one step

// The gain ratio's rule (Nielsen 1999) where a promise is known; else what a good step earns. Nielsen lets a step that
// kept less than half of its promise raise the damping although it was taken. Here it does not: where slopes mislead
// along one direction, as at a kink, no promise is ever kept, and the descent along all others would come to a stop.
double relief(double fall, double promised) {
  if (!(promised > 0)) return most_relief;
  const double u = 2 * std::min(fall / promised, 1.0) - 1;
  return std::clamp(1 - u * u * u, most_relief, 1.0);
}

bool within(double promised, const Amount& amount, double cost) {
  return promised >= 0 && promised <= amount.of(cost);
}

std::string_view reason(Stop stop) {
  switch (stop) {
    case Stop::floor: return "the cost is as low as it can be";
    case Stop::promise: return "the model promises nothing worth another step";
    case Stop::fall: return "the last step gained too little to go on";
    case Stop::step: return "the last step was too short to matter";
    case Stop::rounding: return "what is left to gain drowns in rounding";
    case Stop::barren: return "no step, however short, leads down";
    case Stop::steps: return "the limit on steps was reached before it came to rest";
  }
  return {};
}

}  // namespace

Descended descend(Descent& descent, double cost, const Limits& limits) {
  Descended at{cost, 0, 0, limits.first_damping, Stop::steps};
  const auto stopped = [&](Stop why) {
    at.stop = why;
    return at;
  };
  double growth = 2;
  int refusals = 0;
  bool fresh = true;
  while (at.trials < limits.most_trials) {
    if (at.cost <= limits.floor) return stopped(Stop::floor);
    if (fresh) {
      if (at.steps == limits.most_steps) break;
      descent.linearise();
      ++at.steps;
    }
    const Proposal step = descent.propose(at.damping);
    if (within(step.promised, limits.small_promise, at.cost)) return stopped(Stop::promise);
    ++at.trials;
    const double cost_there = descent.evaluate();
    fresh = cost_there < at.cost;
    if (!fresh) {
      if (step.length < limits.small_step) return stopped(Stop::step);
      if (at.damping >= limits.rounding_damping && within(step.promised, limits.rounding, at.cost))
        return stopped(Stop::rounding);
      if (++refusals >= limits.most_refusals || at.damping >= limits.most_damping) return stopped(Stop::barren);
      at.damping *= growth;
      growth *= 2;
      continue;
    }
    const double fall = at.cost - cost_there;
    const bool calm = at.damping <= limits.calm_damping, little = calm && fall <= limits.small_fall.of(at.cost);
    descent.accept();
    at.cost = cost_there;
    at.damping = std::max(limits.least_damping, at.damping * relief(fall, step.promised));
    growth = 2;
    refusals = 0;
    if (at.cost <= limits.floor) return stopped(Stop::floor);
    if (little) return stopped(Stop::fall);
    if (step.length < limits.small_step) return stopped(Stop::step);
  }
  return stopped(Stop::steps);
}

std::string sentence(const Descended& descended) {
  const std::string steps = std::to_string(descended.steps) + (descended.steps == 1 ? " step" : " steps");
  return "stopped after " + steps + ": " + std::string(reason(descended.stop));
}

}  // namespace gonio::optim
