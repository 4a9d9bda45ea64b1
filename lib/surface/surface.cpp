// Look-up in the registry of surfaces, and parameter values from the manifest.
#include "surface/surface.h"

#include <algorithm>
#include <cmath>

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

Rgb Model::evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const {
  constexpr double share = 1e-5;  // of a number's size
  const auto& parameters = info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    Values below = values, above = values;
    Vec3 width;
    for (int c = 0; c < 3; ++c) {
      const double at = values.v[i][c], range = parameters[i].upper - parameters[i].lower;
      const double step = share * std::max(std::abs(at), 1e-2 * std::min(1.0, range));
      const double low = std::max(at - step, parameters[i].lower), high = std::min(at + step, parameters[i].upper);
      const auto put = [c](Vec3& v, double number) { (c == 0 ? v.x : c == 1 ? v.y : v.z) = number; };
      put(below.v[i], low);
      put(above.v[i], high);
      put(width, high - low);
    }
    const Rgb rise = evaluate(above, wo, wi) - evaluate(below, wo, wi);
    slopes[i] = {rise.x / width.x, rise.y / width.y, rise.z / width.z};
  }
  return evaluate(values, wo, wi);
}

Values values_of(const Model& model, const manifest::Parameters& parameters, const std::string& place) {
  const std::vector<Vec3> checked = manifest::values_of(model.info(), parameters, place);
  Values values;
  std::copy(checked.begin(), checked.end(), values.v.begin());
  return values;
}

}  // namespace gonio::surface
