// Look-up in the registry of lights.
#include "light/light.h"

#include <algorithm>

namespace gonio::light {

const Model* find(const std::string& id) {
  const auto all = all_models();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Model* m) { return m->info().id == id; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace gonio::light
