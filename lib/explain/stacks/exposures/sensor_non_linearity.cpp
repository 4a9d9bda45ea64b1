// sensor.non-linearity in a stack of exposures: tone curves of the channels and of all together, power law with
// toe, with shoulder and alone, quadratic, the most flexible first. Bends only where readings reach beyond the inner
// one of their nodes. A bend is expected to be moderate, so that codes that few readings show do not make the curve
// wave.
//
// Numbers: of every curve the slope and its bends, the common curve first, then each channel's own where there are
// several; gamma; quadratic; toe; shoulder. The curves are alternatives of one family: at most one is not neutral, so
// that slopes multiply and bends add.
#include "render/mechanisms/sensor_non_linearity.h"

#include <tuple>

#include "explain/stacks/exposure_binding.h"
#include "stats/intervals.h"

namespace gonio::explain::stacks::exposures {
namespace {

constexpr double moderate_bend = 0.7;
constexpr double least_support = 0.02;  // share of the readings beyond the next node that a bend needs
constexpr std::size_t bends = std::tuple_size_v<render::ToneBends>, each = 1 + bends;  // numbers of a curve

std::size_t curves_of(const Stack& stack) {
  return stack.channels.size() > 1 ? stack.channels.size() + 1 : 1;
}

void enter_responses(StackEntry& entry, const ExposureFacts& facts) {
  std::vector<double> readings;
  for (const double y : facts.linear) readings.push_back(y / entry.stack.linear_scale());
  const double lowest = stats::quantile(readings, least_support),
               highest = stats::quantile(readings, 1 - least_support);
  const auto reached = [&](std::size_t bend) {
    return bend < render::tone_anchor ? render::tone_nodes[bend + 1] > lowest : render::tone_nodes[bend] < highest;
  };
  std::vector<std::size_t> common, own;
  const std::size_t curves = curves_of(entry.stack);
  for (std::size_t c = 0; c < curves; ++c) {
    const std::string prefix = c == 0 ? "" : entry.stack.channels[c - 1];
    std::vector<std::size_t>& curve = c == 0 ? common : own;
    curve.push_back(entry.count());
    Parameter& slope = entry.add("slope", 1, prefix);
    if (c > 0) slope.neutral = 1;  // what the manifest says is in the common one
    for (std::size_t k = 0; k < bends; ++k) {
      if (reached(k)) curve.push_back(entry.count());
      Parameter& bend = entry.add("bend_" + std::to_string(k + 1), 0.2, prefix);
      if (c > 0) bend.neutral = 0;
      bend.prior_sigma = moderate_bend;
    }
  }
  entry.add("gamma", 0.5);
  entry.add("quadratic", 0.1);
  entry.add("toe", 0.05);
  entry.add("shoulder", 0.5);
  const std::size_t gamma = entry.count() - 4, quadratic = gamma + 1, toe = gamma + 2, shoulder = gamma + 3;
  if (curves > 1) entry.propose(own);
  entry.propose(common);
  entry.propose({gamma, toe});
  entry.propose({gamma, shoulder});
  entry.propose({gamma});
  entry.propose({quadratic});
}

void set_responses(std::span<const double> p, const Stack& stack, ReadingChain& chain) {
  const std::span<const double> closed = p.last(4);  // gamma, quadratic, toe, shoulder
  for (std::size_t c = 0; c < stack.channels.size(); ++c) {
    double slope = p[0];
    render::ToneBends bend;
    for (std::size_t k = 0; k < bends; ++k) bend[k] = p[1 + k];
    if (stack.channels.size() > 1) {
      const std::span<const double> own = p.subspan(each * (c + 1), each);
      slope *= own[0];
      for (std::size_t k = 0; k < bends; ++k) bend[k] += own[1 + k];
    }
    chain.response[c] = {.quadratic = closed[1],
                         .gamma = closed[0],
                         .reference = stack.linear_scale(),
                         .curve = render::ToneCurve(render::slopes_of(slope, bend)),
                         .toe = closed[2],
                         .shoulder = closed[3]};
  }
}

}  // namespace

const ExposureBinding& sensor_non_linearity() {
  static const ExposureBinding binding{.mechanism = mechanism::sensor_non_linearity,
                                       .order = 10,
                                       .written = Written::as_response,
                                       .enter = enter_responses,
                                       .set = set_responses};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
