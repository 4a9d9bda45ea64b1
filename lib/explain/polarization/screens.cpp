// See screens.h.
#include "explain/polarization/screens.h"

#include <cmath>

#include "geom/vector.h"
#include "light/light.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "scene/model_choice.h"

namespace gonio::explain::polarization {
namespace {

double stated(const manifest::Document& document, const std::string& light, const char* key) {
  const manifest::Light& entry = document.lights.at(light);
  const auto given = entry.parameters.find(key);
  if (given != entry.parameters.end() && given->second.given()) return given->second.scalar();
  return scene::find_parameter(light::find(entry.model)->info(), key)->preset.value_or(0);
}

}  // namespace

std::vector<std::string> polarized_lights(const manifest::Document& document) {
  std::vector<std::string> names;
  for (const auto& [name, entry] : document.lights) {
    const light::Model* model = light::find(entry.model);
    if (model != nullptr && scene::find_parameter(model->info(), screen_degree_key) != nullptr &&
        screen_degree(document, name) > 0)
      names.push_back(name);
  }
  return names;
}

double screen_angle_rad(const manifest::Document& document, const std::string& light) {
  return stated(document, light, screen_angle_key);
}
double screen_degree(const manifest::Document& document, const std::string& light) {
  return stated(document, light, screen_degree_key);
}

void set_screen(manifest::Document& document, const std::string& light, const char* key, double value, double sigma) {
  manifest::Light& entry = document.lights.at(light);
  entry.parameters[key].value = {key == screen_angle_key ? std::remainder(value, pi) : value};
  if (sigma > 0) entry.sigma[key] = {sigma};
}

}  // namespace gonio::explain::polarization
