// See switched_on.h.
#include "explain/switched_on.h"

#include <algorithm>

#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"

namespace gonio::explain {

std::map<std::string, manifest::Parameters> switched_on_for(const manifest::Document& document,
                                                            const std::string& domain, const std::string& name) {
  std::map<std::string, manifest::Parameters> all;
  for (const auto& [id, use] : document.mechanisms) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr || std::ranges::find(m->domains, domain) == m->domains.end()) continue;
    const auto on = std::ranges::find(use.on, name);
    if (!use.on.empty() && on == use.on.end()) continue;
    const auto at = static_cast<std::size_t>(on - use.on.begin());
    manifest::Parameters& own = all[id];
    for (const auto& [key, parameter] : use.parameters)
      if (parameter.given()) own[key] = manifest::Parameter(parameter.value[std::min(at, parameter.value.size() - 1)]);
  }
  return all;
}

}  // namespace gonio::explain
