// See prints_outcome.h.
#include "explain/prints/prints_outcome.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "inference/apart.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/print.h"
#include "print/mechanisms/print_ground_noise.h"
#include "report/colour_map.h"

namespace gonio::explain {
namespace {

using prints::Reading, prints::Readings;

constexpr double normal_95 = 1.959963984540054;

std::string squares_svg(const PrintsInput& input, const Readings& readings, std::size_t map,
                        const std::vector<double>& value, double scale) {
  std::string svg = format(
      "<svg viewBox=\"0 0 %d %d\" role=\"img\" shape-rendering=\"crispEdges\" "
      "style=\"background:#ddd;min-width:min(22rem,85vw)\">",
      input.sent.wide(), input.sent.high());
  for (std::size_t i = 0; i < readings.rows.size(); ++i) {
    const Reading& r = readings.rows[i];
    if (r.map != map) continue;
    const std::string colour = report::hex(report::signed_colour(std::clamp(value[i] / scale, -1.0, 1.0)));
    svg += format("<rect x=\"%d\" y=\"%d\" width=\"1\" height=\"1\" fill=\"%s\"/>", r.x_px,
                  input.sent.high() - 1 - r.y_px, colour.c_str());
  }
  return svg + "</svg>";
}

}  // namespace

std::string prints_remarks(const PrintsInput& input, const Readings& readings) {
  std::string text =
      format("%zu pixels of %zu %s were read; their heights have a noise of %.2g um", readings.rows.size(),
             input.maps.size(), input.maps.size() == 1 ? "map" : "maps", readings.noise_um);
  if (readings.without_points > 0)
    text += format("; %zu had too few points, beside steep walls for the most part", readings.without_points);
  return text + ".";
}

void upgrade_print(const PrintsInput& input, const PrintUse& use, const Explanation& e, manifest::Document& document) {
  const std::size_t count = use.neutral.size();
  std::vector<std::ptrdiff_t> at;  // in the covariance; -1: not fitted
  bool active = false;
  for (std::size_t k = 0; k < count; ++k) {
    const auto found = std::ranges::find(e.active, use.first + k);
    at.push_back(found == e.active.end() ? -1 : found - e.active.begin());
    active = active || at.back() >= 0;
  }
  if (!active) return;
  std::vector<double> p(e.values.begin() + static_cast<std::ptrdiff_t>(use.first),
                        e.values.begin() + static_cast<std::ptrdiff_t>(use.first + count));
  manifest::Print& print = document.prints.at(input.name);
  if (use.term->write != nullptr) {
    std::vector<double> covariance(count * count, 0.0);
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = 0; b < count; ++b)
        if (at[a] >= 0 && at[b] >= 0)
          covariance[a * count + b] =
              e.covariance[static_cast<std::size_t>(at[a]) * e.active.size() + static_cast<std::size_t>(at[b])];
    use.term->write(print, input.sent, p, covariance);
    return;
  }
  const mechanism::Mechanism& m = use.term->mechanism();
  manifest::MechanismUse& entry = document.mechanisms[m.id];
  if (std::ranges::find(entry.on, input.name) == entry.on.end()) entry.on.push_back(input.name);
  const auto place = static_cast<std::size_t>(std::ranges::find(entry.on, input.name) - entry.on.begin());
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double>&value = entry.parameters[m.parameters[k].name].value,
    &sigma = entry.sigma[m.parameters[k].name];
    value.resize(entry.on.size()), sigma.resize(entry.on.size());
    value[place] = at[k] < 0 && use.form.held != 0 ? use.form.held : p[k];
    sigma[place] = e.sigma[use.first + k];
  }
}

namespace {

constexpr double no_more = 1.25;  // times the square that ground and noise make

// Neighbours that the ground moves together look like structure to tests that deal in blocks; their size does not.
bool is_all_there_is(const Problem& problem, const Explanation& e) {
  const inference::Observations& o = problem.observations();
  double squares = 0;
  for (std::size_t i = 0; i < o.rows(); ++i) squares += std::pow(e.residual_after[i] / o.sigma[i], 2);
  return squares < no_more * static_cast<double>(o.rows());
}

}  // namespace

void conclude_ground(const Problem& problem, const prints::Ground& ground, double layer_um, std::size_t candidate,
                     Explanation& e) {
  const inference::Candidate& c = problem.candidates()[candidate];
  const double pixel_m = problem.parameters()[c.parameters.at(1)].neutral / 2;
  inference::Apart apart{.candidate = candidate, .estimates = {}, .p = ground.p, .refused = {}};
  const auto estimate = [&](std::size_t which, double value, double log_sigma) {
    const double factor = std::exp(normal_95 * log_sigma);
    apart.estimates.push_back(
        {c.parameters.at(which), value, value * log_sigma, value / factor, value * factor, false});
  };
  estimate(0, 1e-6 * ground.rms_um, ground.log_rms_sigma);
  estimate(1, pixel_m * ground.length_px, ground.log_length_sigma);
  apart.effect = ground.rms_um / layer_um;
  apart.with = apart.without = e.held_out_after;
  if (ground.length_px < 1) apart.refused = "is alike over less than a pixel, as the instrument's noise may be";
  if (e.verdict == inference::Verdict::unknown && apart.refused.empty() && is_all_there_is(problem, e)) {
    e.verdict = e.named.empty() ? inference::Verdict::null : inference::Verdict::named;
    e.outside.reset();
  }
  inference::join(problem, apart, e);
}

void write_ground(const PrintsInput& input, const prints::Ground& ground, manifest::Document& document) {
  manifest::MechanismUse& entry = document.mechanisms[mechanism::print_ground_noise().id];
  const double rms_m = 1e-6 * ground.rms_um, length_m = ground.length_px * input.sent.printer.pixel_m.x;
  entry.on.push_back(input.name);
  entry.parameters["rms_m"].value.push_back(rms_m);
  entry.parameters["length_m"].value.push_back(length_m);
  entry.sigma["rms_m"].push_back(rms_m * ground.log_rms_sigma);
  entry.sigma["length_m"].push_back(length_m * ground.log_length_sigma);
}

Illustration illustrate_prints(const PrintsInput& input, const Readings& readings, const Explanation& e) {
  Illustration result;
  const double scale_um = 5 * readings.noise_um, scale = scale_um / (1e6 * input.sent.printer.layer_m);
  for (std::size_t m = 0; m < input.maps.size(); ++m) {
    result.pictures.push_back(
        {format("%s: heights less the simulation as stated; red: %+.2g um", input.maps[m].relief.c_str(), scale_um), "",
         squares_svg(input, readings, m, e.residual_before, scale)});
    if (!e.named.empty())
      result.pictures.push_back({input.maps[m].relief + ": the same with the named physics", "",
                                 squares_svg(input, readings, m, e.residual_after, scale)});
  }
  return result;
}

}  // namespace gonio::explain
