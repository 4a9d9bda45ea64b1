// Look-up in the registry of surfaces, and parameter values from the manifest.
#include "surface/surface.h"

#include <algorithm>

#include "surface/law.h"

namespace gonio::surface {

const Model* find(const std::string& id) {
  const auto all = all_models();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Model* m) { return m->info().id == id; });
  return found == all.end() ? nullptr : *found;
}

const Law* find_law(const std::string& id) {
  const auto all = all_laws();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Law* law) { return law->info().id == id; });
  return found == all.end() ? nullptr : *found;
}

Values values_of(const Model& model, const manifest::Parameters& parameters, const std::string& place) {
  const std::vector<Vec3> checked = manifest::values_of(model.info(), parameters, place);
  Values values;
  std::copy(checked.begin(), checked.end(), values.v.begin());
  return values;
}

}  // namespace gonio::surface
