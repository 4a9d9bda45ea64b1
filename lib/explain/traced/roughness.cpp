// See roughness.h.
#include "explain/traced/roughness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"

namespace gonio::explain::traced {
namespace {

constexpr double passage = 0.2;  // of a layer: sharp steps have no slopes

const surface::Law& law_of(const std::string& id) {
  const surface::Law* law = surface::find_law(id);
  if (law == nullptr) throw Error(Exit::internal, id, "is no law");
  return *law;
}

double value_of(const std::string& id, const manifest::Parameters& stated, const surface::LocalGeometry& here) {
  const surface::Law& law = law_of(id);
  std::vector<double> amounts;
  for (const manifest::ParameterInfo& p : law.info().parameters) {
    const auto found = stated.find(p.name);
    amounts.push_back(found != stated.end() ? found->second.scalar() : p.preset.value_or(0));
  }
  return law.value(amounts, here);
}

// The law in force and its numbers; no name: none.
std::pair<std::string, manifest::Parameters> law_in_force(const Roughness& r, double even) {
  if (r.slopes > 0) return {"print-normal", {{"rho", even}, {"s", 1 / r.slopes}}};
  if (r.layers != 0)
    return {"print-layers",
            {{"alpha_even", even},
             {"alpha_odd", std::clamp(even + r.layers, r.lower, r.upper)},
             {"layer_m", r.layer_m},
             {"offset_m", r.layer_offset_m}}};
  if (r.reach_m > 0) return {"polish-curvature", {{"rho", even}, {"s", r.polish}, {"curvature_per_m", 1 / r.reach_m}}};
  return {};
}

}  // namespace

double Roughness::even() const {
  return more > 0 ? std::min(upper, std::hypot(alpha, more)) : alpha;
}

double Roughness::at(const surface::LocalGeometry& here) const {
  const double a = even();
  auto [law, numbers] = law_in_force(*this, a);
  if (law.empty()) return a;
  if (layers != 0) numbers["transition_m"] = passage * layer_m;
  return std::clamp(value_of(law, numbers, here), lower, upper);
}

void Roughness::write(manifest::Document& document, const std::string& name) const {
  manifest::Surface& surface = document.surfaces.at(name);
  auto [law, numbers] = law_in_force(*this, even());
  if (law.empty()) {
    surface.parameters["alpha"].value = {even()};
    return;
  }
  surface.parameters.erase("alpha"), surface.sigma.erase("alpha");
  surface.laws["alpha"] = {.law = law, .parameters = numbers};
}

}  // namespace gonio::explain::traced
