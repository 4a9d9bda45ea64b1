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

constexpr double likely_strength = 0.3;  // of a free lamp's logarithm; albedo takes what is common
constexpr double likely_slope = 0.2;     // of the same, over half the picture's width

constexpr std::size_t fewest_lamps = 5;  // that must show a pixel of the whole picture

}  // namespace

// Strengths of the lamps.
void PhotometricProblem::add_lamps() {
  for (std::size_t g = 0; g < lamps_.size(); ++g) {
    const std::string& name = stack_.images[g].light;
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

void PhotometricProblem::add_mechanisms(const manifest::Document& document) {
  const auto all = all_light_bindings();
  std::vector<const LightBinding*> bindings(all.begin(), all.end());
  std::ranges::stable_sort(bindings, {}, &LightBinding::order);
  for (const LightBinding* binding : bindings) {
    StackEntry entry(document, stack_, binding->mechanism(), parameters_, base_, candidates_);
    binding->enter(entry);
    bound_.push_back({binding, entry.first, entry.count()});
  }
}

const PhotometricProblem::Bound& PhotometricProblem::bound_of(std::size_t candidate) const {
  const std::size_t number = candidates_[candidate].parameters[0];
  return *std::ranges::find_if(bound_, [&](const Bound& b) { return number >= b.first && number < b.first + b.count; });
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
  for (const Bound& bound : bound_)
    if (bound.binding->remark != nullptr && is_named(*this, e, bound.binding->mechanism().id))
      text += (text.empty() ? "" : " ") + bound.binding->remark(bound.of(e.values));
  return text;
}

void PhotometricProblem::apply(const Explanation& e, manifest::Document& document) const {
  const PatchModel now = model(e.values);
  const auto written = [&](std::size_t c) { return bound_of(c).binding->written; };
  const bool bent = std::ranges::any_of(e.named, [&](std::size_t c) { return written(c) == Written::as_response; });
  if (bent) {
    const std::vector<render::Response> same(3, now.response);
    state_responses(stack_, same, now.offset, document);
  }
  for (const std::size_t c : e.named) {
    if (!is_switched_on(written(c), bent)) continue;
    switch_on(candidates_[c], written_on(stack_, candidates_[c]), e, document);
    if (const LightBinding& binding = *bound_of(c).binding; binding.complete != nullptr)
      binding.complete(document.mechanisms[binding.mechanism().id]);
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
