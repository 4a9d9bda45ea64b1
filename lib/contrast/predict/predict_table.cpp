// Predicted contrasts as entries of the manifest and as tables of comma-separated values (predict.h). Tables have
// angles in degrees, for people's spreadsheets; the names say so.
#include "base/text.h"
#include "contrast/predict/predict.h"
#include "manifest/sections/contrast.h"

namespace gonio::contrast {
namespace {

std::string column(const std::string& parameter) {
  return parameter.ends_with("_rad") ? parameter.substr(0, parameter.size() - 4) + "_deg" : parameter;
}

std::string number(const std::string& parameter, double value) {
  return parameter.ends_with("_rad") ? degrees_text(value) : shortest_text(value);
}

std::string both(const Estimate& e) {
  return format(",%.7g,%.3g", e.value, e.sigma);
}

}  // namespace

std::string combinations_csv(const Prediction& p) {
  std::string text;
  for (const Varied& v : p.varied) text += column(v.parameter) + ",";
  text +=
      "tilt_deg,first_rotation_deg,second_rotation_deg,first_per_sr,first_sigma,second_per_sr,second_sigma,"
      "difference_per_sr,difference_sigma,michelson,michelson_sigma\n";
  for (const Combination& c : p.combinations) {
    for (std::size_t i = 0; i < p.varied.size(); ++i) text += number(p.varied[i].parameter, c.varied[i]) + ",";
    text += degrees_text(c.tilt_rad) + "," + degrees_text(c.pair_rad.first) + "," + degrees_text(c.pair_rad.second) +
            both(c.first) + both(c.second) + both(c.difference) + both(c.michelson) + "\n";
  }
  return text;
}

std::string means_csv(const Prediction& p) {
  std::string text = "over,at,mean_contrast,sigma\n";
  for (const Means& m : p.means)
    for (std::size_t i = 0; i < m.mean.size(); ++i)
      text += (m.over == "tilt"       ? "tilt_deg"
               : m.over == "rotation" ? "rotation_deg"
                                      : column(m.over)) +
              "," + m.label[i] + both(m.mean[i]) + "\n";
  return text;
}

std::vector<manifest::Contrast> entries_of(const Prediction& p) {
  std::vector<manifest::Contrast> entries;
  for (const Combination& c : p.combinations) {
    manifest::Contrast entry;
    entry.action = "predict";
    entry.surface = p.surface;
    entry.pair_rad = {c.pair_rad.first, c.pair_rad.second};
    entry.tilt_rad = c.tilt_rad;
    entry.light_rad = p.experiment.light_rad;
    for (std::size_t i = 0; i < p.varied.size(); ++i) entry.parameters[p.varied[i].parameter] = c.varied[i];
    entry.signals = {c.first.value, c.second.value};
    const double sign = c.first_brighter ? 1 : -1;
    entry.difference = sign * c.difference.value;
    entry.michelson = sign * c.michelson.value;
    if (p.draws > 0)
      entry.sigma = {{"signals", {c.first.sigma, c.second.sigma}},
                     {"difference", {c.difference.sigma}},
                     {"michelson", {c.michelson.sigma}}};
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace gonio::contrast
