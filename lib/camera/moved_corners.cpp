// See moved_corners.h.
#include "camera/moved_corners.h"

#include <algorithm>

#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"

namespace gonio::camera {

bool moves_corners(const std::string& id, const manifest::MechanismUse& use) {
  const mechanism::Mechanism* m = mechanism::find_mechanism(id);
  if (m == nullptr || std::ranges::find(m->domains, "boards") == m->domains.end()) return false;
  return std::ranges::any_of(m->parameters, [&](const mechanism::Parameter& p) {
    const auto given = use.parameters.find(p.name);
    return given != use.parameters.end() &&
           std::ranges::any_of(given->second.value, [&](double v) { return v != p.neutral; });
  });
}

}  // namespace gonio::camera
