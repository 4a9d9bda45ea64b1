// See photometric_problem.h: the candidates, the words, the upgraded manifest and the pictures of a stack of lights.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "explain/stacks/photometric_problem.h"
#include "explain/stacks/stack_manifest.h"
#include "explain/stacks/stack_pictures.h"
#include "inference/explanation.h"
#include "inference/sentence.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::explain::stacks {
namespace {

constexpr double likely_turn_rad = 0.1;  // of a lamp; also holds all of them, which could turn with all normals
constexpr double likely_strength = 0.3;  // of a free lamp's logarithm; albedo takes what is common
constexpr double likely_slope = 0.2;     // of the same, over half the picture's width
constexpr double highest_f0 = 0.2;       // readings need not be on an absolute scale

constexpr double nearest = 0.7;  // half widths' inverse: a lamp just outside the picture

constexpr std::size_t fewest_lamps = 5;  // that must show a pixel of the whole picture

}  // namespace

// Turns and strengths of the lamps.
void PhotometricProblem::add_lamps(const manifest::Document& document) {
  for (std::size_t g = 0; g < lamps_.size(); ++g) {
    const std::string& name = stack_.images[g].light;
    std::array<std::size_t, 2> tilt{};
    for (int axis = 0; axis < 2; ++axis) {
      const std::string key = axis == 0 ? "tilt_x_rad" : "tilt_y_rad";
      Parameter p = declared(document, "light.direction", key, name + "/" + key, name, 0.05);
      p.groups = {g};
      p.prior_sigma = likely_turn_rad;
      tilt[static_cast<std::size_t>(axis)] = parameters_.size();
      parameters_.push_back(std::move(p));
    }
    tilt_.push_back(tilt);
    Parameter strength;
    strength.name = "lights/" + name + "/log_strength";
    strength.unit = "1";
    strength.size = 0.1;
    strength.prior_sigma = likely_strength;
    strength.groups = {g};
    strength_.push_back(parameters_.size());
    if (free_[g]) base_.push_back(parameters_.size());
    parameters_.push_back(std::move(strength));
    std::array<std::size_t, 2> slope{};
    for (int axis = 0; axis < 2; ++axis) {
      Parameter p;
      p.name = "lights/" + name + (axis == 0 ? "/slope_right" : "/slope_down");
      p.unit = "1";
      p.size = 0.05;
      p.prior_sigma = likely_slope;
      p.groups = {g};
      slope[static_cast<std::size_t>(axis)] = parameters_.size();
      if (free_[g]) base_.push_back(parameters_.size());
      parameters_.push_back(std::move(p));
    }
    slope_.push_back(slope);
  }
}

void PhotometricProblem::propose_candidate(const manifest::Document& document, const std::string& id,
                                           std::vector<std::size_t> parameters, const std::string& target) {
  const mechanism::Mechanism* m = mechanism::find_mechanism(id);
  if (m == nullptr || is_given(document, id, target)) return;
  Candidate candidate;
  candidate.mechanism = m;
  candidate.parameters = std::move(parameters);
  candidate.family = id;
  candidates_.push_back(std::move(candidate));
}

void PhotometricProblem::add_candidates(const manifest::Document& document) {
  const auto add = [&](const std::string& id, const std::string& name, double size) -> std::size_t {
    const bool of_camera = id.starts_with("sensor.");
    parameters_.push_back(declared(document, id, name, id + "." + name, of_camera ? stack_.camera : "", size));
    return parameters_.size() - 1;
  };
  shared_.f0 = add("surface.interface", "f0", 0.02);
  parameters_.back().upper = highest_f0;
  shared_.alpha = add("surface.interface", "alpha", 0.1);
  shared_.sigma_rad = add("surface.diffuse-roughness", "sigma_rad", 0.1);
  shared_.ambient = add("light.ambient", "radiance_g", 0.01);
  shared_.gamma = add("sensor.non-linearity", "gamma", 0.2);
  shared_.quadratic = add("sensor.non-linearity", "quadratic", 0.1);
  shared_.offset = add("sensor.black-offset", "offset", 0.05 * stack_.full_scale);
  parameters_.back().lower = -stack_.full_scale, parameters_.back().upper = stack_.full_scale;
  parameters_.back().start = 0.005 * stack_.full_scale;
  shared_.falloff = add("optics.vignetting", "falloff", 0.1);
  shared_.nearness = add("light.inverse-square", "nearness_per_m", 0.1);
  parameters_.back().upper = nearest;
  propose_candidate(document, "surface.interface", {shared_.f0, shared_.alpha}, "");
  propose_candidate(document, "surface.diffuse-roughness", {shared_.sigma_rad}, "");
  std::vector<std::size_t> tilts;
  for (const std::array<std::size_t, 2>& tilt : tilt_) tilts.insert(tilts.end(), tilt.begin(), tilt.end());
  propose_candidate(document, "light.direction", tilts, stack_.images[0].light);
  for (const StackImage& image : stack_.images)
    if (!candidates_.empty() && candidates_.back().id() == "light.direction")
      candidates_.back().on.push_back(image.light);
  propose_candidate(document, "light.inverse-square", {shared_.nearness}, stack_.images[0].light);
  propose_candidate(document, "light.ambient", {shared_.ambient}, "");
  propose_candidate(document, "sensor.non-linearity", {shared_.gamma}, stack_.camera);
  propose_candidate(document, "sensor.non-linearity", {shared_.quadratic}, stack_.camera);
  propose_candidate(document, "sensor.black-offset", {shared_.offset}, stack_.camera);
  propose_candidate(document, "optics.vignetting", {shared_.falloff}, "");
}

std::string PhotometricProblem::remarks(const Explanation& e) const {
  std::string text;
  if (hidden_ > 0)
    text = std::to_string(hidden_) + " of " + std::to_string(hidden_ + observations_.rows()) +
           " readings lie in cast shadows and were left out.";
  std::size_t worst = 0;
  const auto slope = [&](std::size_t g) { return std::hypot(e.values[slope_[g][0]], e.values[slope_[g][1]]); };
  for (std::size_t g = 0; g < slope_.size(); ++g)
    if (slope(g) > slope(worst)) worst = g;
  if (slope(worst) > evenness)
    text += (text.empty() ? "" : " ") + std::string("The light of ") + stack_.images[worst].light + " changes by " +
            printed(100 * slope(worst)) + " % over half the picture's width.";
  if (is_named(*this, e, "light.inverse-square"))
    text += (text.empty() ? "" : " ") + std::string("The lamps stand ") + printed(1 / e.values[shared_.nearness]) +
            " half widths of the picture away; without a scale the manifest cannot say so in metres.";
  if (!is_named(*this, e, "light.direction")) return text;
  double sum = 0;
  for (const std::array<std::size_t, 2>& t : tilt_) sum += std::hypot(e.values[t[0]], e.values[t[1]]);
  return text + (text.empty() ? "" : " ") + "The lamps stand " +
         printed(sum / static_cast<double>(tilt_.size()) * 180 / pi) +
         " degrees away from where they were said to be, "
         "on average.";
}

void PhotometricProblem::apply(const Explanation& e, manifest::Document& document) const {
  const PatchModel now = model(e.values);
  const bool bent = is_named(*this, e, "sensor.non-linearity");
  if (bent) {
    const std::vector<render::Response> same(3, now.response);
    state_responses(stack_, same, now.offset, document);
  }
  for (const std::size_t c : e.named) {
    const std::string& id = candidates_[c].id();
    if (id == "light.inverse-square") continue;  // a stack without geometry has no metre
    if (id == "sensor.non-linearity" || (bent && id == "sensor.black-offset")) continue;
    std::vector<std::string> on;
    if (id == "light.direction") on = candidates_[c].on;
    if (id == "sensor.black-offset" && !stack_.camera.empty()) on = {stack_.camera};
    switch_on(candidates_[c], on, e, document);
    if (id != "light.ambient") continue;
    manifest::MechanismUse& use = document.mechanisms[id];
    for (const char* name : {"radiance_r", "radiance_g", "radiance_b"}) {
      use.parameters[name] = manifest::Parameter(e.values[shared_.ambient]);
      use.sigma[name] = {e.sigma[shared_.ambient]};
    }
  }
  for (std::size_t g = 0; g < lamps_.size(); ++g) {
    const std::size_t p = strength_[g];
    if (std::find(base_.begin(), base_.end(), p) == base_.end()) continue;
    manifest::Light& light = document.lights.at(stack_.images[g].light);
    manifest::Parameter& watt = light.parameters.at("watt_per_m2");
    for (double& v : watt.value) v *= lamps_[g].white / stated_[g] * std::exp(e.values[p]);
    light.sigma["watt_per_m2"] = std::vector<double>(watt.value.size(), e.sigma[p] * mean(watt.rgb()));
  }
}

Illustration PhotometricProblem::illustrate(const Explanation& e, const std::filesystem::path& out,
                                            manifest::Document& document) const {
  Illustration result;
  if (e.verdict == Verdict::null) return result;
  Effects effects = empty_effects(stack_);
  const PatchModel before = model(e.base_values), after = model(e.values);
  std::vector<double> rms;
  for (const StackImage& image : stack_.images) {
    double sum = 1e-30, n = 1e-30;
    for (std::size_t i = 0; i < image.counts.size(); ++i)
      if (image.counts[i]) sum += double{image.picture.data[i]} * image.picture.data[i], n += 1;
    rms.push_back(std::sqrt(sum / n));
  }
  const std::size_t channels = stack_.channels.size();
  parallel_for(0, static_cast<std::size_t>(effects.height), [&](std::size_t row) {
    for (int column = 0; column < effects.width; ++column) {
      const int x = column * effects.stride, y = static_cast<int>(row) * effects.stride;
      PatchReadings was = readings(x, y, lights(e.base_values, x, y), e.noise_factor);
      const auto shown = std::count_if(was.weight.begin(), was.weight.end(), [](double w) { return w > 0; });
      if (static_cast<std::size_t>(shown) < channels * fewest_lamps) continue;
      std::vector<char> dark;
      const Patch start = matte_patch(was, dark);
      for (std::size_t i = 0; i < was.weight.size(); ++i)
        if (dark[i / channels]) was.weight[i] = 0;  // cast shadows say nothing
      PatchReadings is = was;
      is.lights = lights(e.values, x, y);
      const Patch b = fitted_patch(before, was, start);
      const Patch a = e.named.empty() ? b : fitted_patch(after, is, b);
      const std::size_t place = row * static_cast<std::size_t>(effects.width) + static_cast<std::size_t>(column);
      for (std::size_t i = 0; i < was.weight.size(); ++i) {
        if (!(was.weight[i] > 0)) continue;
        const std::size_t g = i / channels, c = i % channels;
        const double f = before(b.b, b.tint[c], was.lights[g], was.radius);
        const double then = e.named.empty() ? was.y[i] : after(a.b, a.tint[c], is.lights[g], is.radius);
        float &effect = effects.effect[g][place], &share = effects.share[g][place];
        effect = std::max(effect, static_cast<float>(std::abs(then - f) * was.weight[i]));
        share = std::max(share, static_cast<float>(std::abs(then - f) / rms[g]));
      }
    }
  });
  add_effects(stack_, effects, e, out, document, result);
  return result;
}

}  // namespace gonio::explain::stacks
