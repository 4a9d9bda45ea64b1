// sensor.non-linearity: forms of one response, stated at the largest value of the pictures; alternatives, of which the
// plainest that is as good as any is named. One response for all cameras of the set; one camera of several, or each by
// itself, where the forms with one number serve. Brightness that is free takes up what the reference is. Forms, by the
// numbers that are free: quadratic; power law; power law with a linear toe; power law with a shoulder; a rising spline
// with few knots (of the tone curve every second bend, where enough readings lie beyond it).
#include "render/mechanisms/sensor_non_linearity.h"

#include <algorithm>
#include <map>

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"
#include "stats/intervals.h"

namespace gonio::relighting::terms {
namespace {

constexpr double least_support = 0.02;  // share of the readings beyond a knot that its bend needs
constexpr double most_bend = 2;

// Free numbers and where their search starts.
using Form = std::map<std::string, double>;

// Readings over the largest, every seventeenth counted one.
std::vector<double> readings_of(const Recordings& recordings, double largest) {
  std::vector<double> readings;
  for (const Recording& image : recordings.images)
    for (std::size_t i = 0; i < image.picture.data.size(); i += 17)
      if (image.counts[i / 3] && image.picture.data[i] > 0) readings.push_back(image.picture.data[i] / largest);
  return readings;
}

Form spline(const Recordings& recordings, double largest) {
  Form form{{"slope", 1.1}};
  const std::vector<double> readings = readings_of(recordings, largest);
  if (readings.empty()) return form;
  const double lowest = stats::quantile(readings, least_support),
               highest = stats::quantile(readings, 1 - least_support);
  for (std::size_t k = 1; k + 1 < render::tone_nodes.size(); k += 2)
    if (render::tone_nodes[k + 1] > lowest && render::tone_nodes[k] < highest)
      form["bend_" + std::to_string(k + 1)] = 0.05;
  return form;
}

void free_only(const Form& form, double reference, Use& use) {
  const std::vector<mechanism::Parameter>& declared = use.mechanism->parameters;
  for (std::size_t k = 0; k < use.numbers.size(); ++k) {
    const std::string& name = declared[k % declared.size()].name;
    Number& number = use.numbers[k];
    const auto found = form.find(name);
    number.free = found != form.end();
    number.start = number.free ? found->second : name == "reference" ? reference : number.neutral;
    if (name.starts_with("bend")) number.lower = -most_bend, number.upper = most_bend;
  }
}

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses;
  const double largest = largest_value(s.recordings);
  const auto add = [&](Use use, const Form& form) {
    free_only(form, largest, use);
    use.family = use.mechanism->id;
    uses.push_back(std::move(use));
  };
  const std::vector<Form> plain = {{{"quadratic", -0.02}}, {{"gamma", 0.9}}};
  std::vector<Form> forms = plain;
  forms.push_back({{"gamma", 0.7}, {"toe", 0.05}});
  forms.push_back({{"gamma", 1.2}, {"shoulder", 0.5}});
  forms.push_back(spline(s.recordings, largest));
  const std::vector<Use> single = camera_uses(s, mechanism::sensor_non_linearity());
  if (single.empty()) return uses;
  std::vector<std::string> all;
  for (const Use& use : single) all.push_back(use.on[0]);
  const auto of_all = [&](bool shared) {
    return target_use(mechanism::sensor_non_linearity(), all, std::vector<std::size_t>(all.size()), shared);
  };
  for (const Form& form : forms) add(of_all(true), form);
  for (std::size_t k = 0; k < plain.size() && all.size() > 1; ++k) add(of_all(false), plain[k]);
  for (std::size_t c = 0; c < single.size() && single.size() > 1; ++c)
    for (const Form& form : plain) add(single[c], form);
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const render::Response response = equation::sensor_non_linearity(camera_amounts(use, frame));
  for (double& v : values) v = response(v);
}

}  // namespace

const Term& sensor_non_linearity() {
  static const Term term{
      .mechanism = mechanism::sensor_non_linearity,
      .reach = Reach::record,
      .order = 60,
      .candidates = candidates,
      .record = record,
      .pointwise = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
