// See exposures_problem.h: the candidates. What the manifest's mechanisms already say of the camera belongs to the base
// model and is not proposed again.
#include <algorithm>
#include <cmath>

#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/stack_manifest.h"
#include "stats/intervals.h"

namespace gonio::explain::stacks {
namespace {

constexpr double moderate_bend = 0.7;
constexpr double least_support = 0.02;  // share of the readings beyond the next node that a bend needs

}  // namespace

std::size_t ExposuresProblem::add_parameter(const manifest::Document& document, const std::string& id,
                                            const std::string& name, double size, const std::string& prefix) {
  parameters_.push_back(
      declared(document, id, name, prefix.empty() ? id + "." + name : prefix + "/" + name, stack_.camera, size));
  return parameters_.size() - 1;
}

void ExposuresProblem::add_candidate(const manifest::Document& document, const std::string& id,
                                     std::vector<std::size_t> parameters) {
  const mechanism::Mechanism* m = mechanism::find_mechanism(id);
  if (m == nullptr || is_given(document, id, stack_.camera)) return;
  Candidate candidate;
  candidate.mechanism = m;
  candidate.parameters = std::move(parameters);
  candidate.family = id;
  candidates_.push_back(std::move(candidate));
}

// Tone curves of the channels and of all together, power law, quadratic: the most flexible first. Bends only where
// readings reach beyond the inner one of their nodes. A bend is expected to be moderate, so that codes that few
// readings show do not make the curve wave.
void ExposuresProblem::add_responses(const manifest::Document& document) {
  const std::string id = "sensor.non-linearity";
  std::vector<double> readings;
  for (const double y : observations_.value) readings.push_back(y / stack_.full_scale);
  const double lowest = stats::quantile(readings, least_support),
               highest = stats::quantile(readings, 1 - least_support);
  const auto reached = [&](std::size_t bend) {
    return bend < render::tone_anchor ? render::tone_nodes[bend + 1] > lowest : render::tone_nodes[bend] < highest;
  };
  std::vector<std::vector<std::size_t>> curves;
  const std::size_t count = stack_.channels.size() > 1 ? stack_.channels.size() + 1 : 1;
  for (std::size_t c = 0; c < count; ++c) {
    const std::string prefix = c == 0 ? "" : stack_.channels[c - 1];
    std::vector<std::size_t> curve;
    curve.push_back(shared_.slope[c] = add_parameter(document, id, "slope", 1, prefix));
    if (c > 0) parameters_.back().neutral = 1;  // what the manifest says is in the common one
    for (std::size_t k = 0; k < shared_.bend[c].size(); ++k) {
      shared_.bend[c][k] = add_parameter(document, id, "bend_" + std::to_string(k + 1), 0.2, prefix);
      if (c > 0) parameters_.back().neutral = 0;
      parameters_.back().prior_sigma = moderate_bend;
      if (reached(k)) curve.push_back(shared_.bend[c][k]);
    }
    curves.push_back(std::move(curve));
  }
  shared_.gamma = add_parameter(document, id, "gamma", 0.5);
  shared_.quadratic = add_parameter(document, id, "quadratic", 0.1);
  if (count > 1) {
    std::vector<std::size_t> all;
    for (std::size_t c = 1; c < count; ++c) all.insert(all.end(), curves[c].begin(), curves[c].end());
    add_candidate(document, id, all);
  }
  add_candidate(document, id, curves[0]);
  add_candidate(document, id, {shared_.gamma});
  add_candidate(document, id, {shared_.quadratic});
}

void ExposuresProblem::add_shared(const manifest::Document& document) {
  add_responses(document);
  const double scale = stack_.full_scale;
  double shortest = taken_[0].exposure_s;
  bool timed = true;
  for (const StackImage& image : stack_.images) {
    shortest = std::min(shortest, image.exposure_s);
    timed = timed && image.time_s.has_value();
  }
  // Bounds of offset and full scale that these readings allow.
  shared_.offset = add_parameter(document, "sensor.black-offset", "offset", 0.1 * scale);
  Parameter& offset = parameters_[shared_.offset];
  offset.lower = -scale, offset.upper = scale, offset.start = 0.005 * scale;
  add_candidate(document, "sensor.black-offset", {shared_.offset});

  // Whether codes were rounded or cut off is not known: up to half a code of offset is nobody's physics.
  Parameter rounding;
  rounding.name = "rounding";
  rounding.unit = "1";
  rounding.size = stack_.quantum > 0 ? stack_.quantum : 1;
  rounding.lower = -0.5 * stack_.quantum, rounding.upper = 0.5 * stack_.quantum;
  rounding.prior_sigma = rounding.size / std::sqrt(12.0);
  shared_.rounding = parameters_.size();
  if (stack_.quantum > 0) base_.push_back(shared_.rounding);
  parameters_.push_back(rounding);

  shared_.full_scale = add_parameter(document, "sensor.saturation", "full_scale", scale);
  Parameter& full = parameters_[shared_.full_scale];
  const double largest = *std::max_element(observations_.value.begin(), observations_.value.end());
  full.lower = 0.05 * largest, full.upper = 1.5 * largest, full.start = 0.98 * largest;
  full.prior_sigma = scale;  // clipped readings leave no residual, and would promise a number without any uncertainty
  add_candidate(document, "sensor.saturation", {shared_.full_scale});

  shared_.extra_s = add_parameter(document, "sensor.shutter", "extra_s", shortest);
  Parameter& extra = parameters_[shared_.extra_s];
  extra.lower = std::max(extra.lower, -0.5 * shortest);
  extra.start = std::min(extra.start, 0.01 * shortest);
  add_candidate(document, "sensor.shutter", {shared_.extra_s});

  shared_.glare = add_parameter(document, "optics.veiling-glare", "share", 0.1);
  add_candidate(document, "optics.veiling-glare", {shared_.glare});

  shared_.drift = add_parameter(document, "light.drift", "amplitude", 0.1);
  shared_.drift_s = add_parameter(document, "light.drift", "time_constant_s", 100);
  if (timed) add_candidate(document, "light.drift", {shared_.drift, shared_.drift_s});
}

}  // namespace gonio::explain::stacks
