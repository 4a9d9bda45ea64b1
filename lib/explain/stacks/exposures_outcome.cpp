// See exposures_problem.h: the words, the upgraded manifest and the pictures of a stack of exposures.
#include <algorithm>
#include <cmath>

#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/moved_outcome.h"
#include "explain/stacks/stack_manifest.h"
#include "explain/stacks/stack_pictures.h"
#include "inference/explanation.h"
#include "inference/sentence.h"
#include "render/mechanisms/sensor_blooming.h"

namespace gonio::explain::stacks {
std::string ExposuresProblem::remarks(const Explanation& e) const {
  std::string text;
  const std::string flowed =
      is_named(*this, e, mechanism::sensor_blooming().id) ? overflow_remark(overflow_) : std::string();
  for (const std::string& remark : {moved_remark(stack_, moved_), response_remark(e), flowed, hot_pixels_remark(hot_)})
    if (!remark.empty()) text += (text.empty() ? "" : " ") + remark;
  return text;
}

std::string ExposuresProblem::response_remark(const Explanation& e) const {
  const auto response =
      std::ranges::find_if(e.named, [&](std::size_t c) { return written(c) == Written::as_response; });
  if (response == e.named.end()) return "";
  const std::vector<std::size_t>& own = candidates_[*response].parameters;
  const std::string& form = parameters_[own[0]].name;
  if (form.ends_with(".quadratic"))
    return "The response departs from proportion by " + printed(100 * e.values[own[0]]) + " % at the reading " +
           printed(stack_.full_scale) + ".";
  const std::string& id = candidates_[*response].id();
  if (form == id + ".gamma" && own.size() == 1)
    return "The response is a power law: readings grow with the light to the power " + printed(e.values[own[0]]) + ".";
  ReadingChain now = chain(e.values);
  now.offset = 0;
  const bool of_all = form == id + ".slope" || form == id + ".gamma";
  std::string text = of_all ? "The response is a tone curve" : "The response is a tone curve of each channel";
  text += ", not one power: where it reads";
  for (const double z : {0.25, 0.5, 0.75}) {
    const int channel = stack_.channels.size() > 1 ? 1 : 0;
    const double at = z * stack_.full_scale;
    const double slope = std::log(now.light(1.01 * at, channel) / now.light(at / 1.01, channel)) / (2 * std::log(1.01));
    text += (z == 0.25 ? " " : z == 0.75 ? " and " : ", ") + printed(100 * z) + " %";
    text += " of " + printed(stack_.full_scale) + " it grows with the light to the power " + printed(1 / slope, 2);
  }
  return text + (stack_.channels.size() > 1 ? " (green)." : ".");
}

void ExposuresProblem::apply(const Explanation& e, manifest::Document& document) const {
  const bool bent = std::ranges::any_of(e.named, [&](std::size_t c) { return written(c) == Written::as_response; });
  const ReadingChain now = chain(e.values);
  if (bent) state_responses(stack_, now.response, now.offset, document);
  for (const std::size_t c : e.named)
    if (is_switched_on(written(c), bent)) switch_on(candidates_[c], written_on(stack_, candidates_[c]), e, document);
}

Illustration ExposuresProblem::illustrate(const Explanation& e, const std::filesystem::path& out,
                                          manifest::Document& document) const {
  Illustration result;
  add_moved(stack_, moved_, result);
  std::vector<CurveDot> dots;
  const ReadingChain before = chain(e.base_values), after = chain(e.values);
  std::size_t row = 0;
  for (std::size_t g = 0; g < rows_.size(); ++g)
    for (const std::size_t s : rows_[g])
      dots.push_back({sites_[s].channel, radiance(after, e.values, s) * taken_[g].exposure_s * taken_[g].gain,
                      observations_.value[row++]});
  const std::string title = "Readings over radiance times exposure, both logarithmic";
  const std::string lines = stack_.stated.empty() ? "a linear sensor" : "the response as it is stated";
  result.pictures.push_back(
      {title + (e.named.empty() ? "; the lines are " : ", with what was fitted; dashed, ") + lines, "",
       curve_drawing(stack_, after, dots)});
  if (e.verdict != Verdict::null)
    add_effects(stack_, exposure_effects(stack_, noise_, taken_, before, after, !e.named.empty()), e, out, document,
                result);
  return result;
}

}  // namespace gonio::explain::stacks
