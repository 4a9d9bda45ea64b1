// Values of a registered model's parameters: presets filled in, names, counts and bounds checked (manifest/model.h).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "base/error.h"
#include "manifest/model.h"

namespace gonio::manifest {
namespace {

std::string digits(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

std::string names_of(const ModelInfo& model) {
  std::string names;
  for (const ParameterInfo& p : model.parameters) names += (names.empty() ? "" : ", ") + p.name;
  return names;
}

Vec3 checked(const ParameterInfo& info, const std::vector<double>& given, const std::string& place) {
  const auto count = static_cast<std::size_t>(info.components);
  if (given.size() != count && !(info.rgb && given.size() == 1))
    throw Error(Exit::data, place, std::to_string(given.size()) + " numbers where " + std::to_string(count) + " belong",
                info.meaning);
  for (const double v : given)
    if (!(v >= info.lower && v <= info.upper) || !std::isfinite(v))
      throw Error(Exit::data, place,
                  "value " + digits(v) + " is outside " + digits(info.lower) + " to " + digits(info.upper),
                  info.meaning);
  return given.size() == 3 ? Vec3{given[0], given[1], given[2]} : Vec3{given[0], given[0], given[0]};
}

}  // namespace

std::vector<Vec3> values_of(const ModelInfo& model, const Parameters& parameters, const std::string& place) {
  for (const auto& [name, parameter] : parameters) {
    const auto known = std::any_of(model.parameters.begin(), model.parameters.end(),
                                   [&, key = &name](const ParameterInfo& p) { return p.name == *key; });
    if (!known)
      throw Error(Exit::data, place + "/" + name, "model \"" + model.id + "\" has no such parameter",
                  "it takes " + names_of(model));
  }
  std::vector<Vec3> values;
  for (const ParameterInfo& info : model.parameters) {
    const auto found = parameters.find(info.name);
    if (found != parameters.end() && found->second.given()) {
      values.push_back(checked(info, found->second.value, place + "/" + info.name));
    } else if (info.preset) {
      values.push_back({*info.preset, *info.preset, *info.preset});
    } else {
      throw Error(Exit::data, place, "model \"" + model.id + "\" needs " + info.name, info.meaning);
    }
  }
  return values;
}

}  // namespace gonio::manifest
