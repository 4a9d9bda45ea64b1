#include "scene/placement.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/sections/mechanism_use.h"
#include "scene/amounts.h"
#include "scene/edit.h"

namespace gonio::scene {

using mechanism::Mechanism;

bool applies_to_objects(const Mechanism& mechanism) {
  const Edit* edit = find_edit(mechanism);
  return edit != nullptr && edit->instance != nullptr;
}

Instance moved(const Instance& instance, const Mechanism& mechanism, std::span<const double> amounts) {
  Instance result = instance;
  if (!neutral(mechanism, amounts)) find_edit(mechanism)->instance(result, amounts);
  return result;
}

void apply_mechanism(std::vector<Instance>& instances, const Mechanism& mechanism, const manifest::MechanismUse& use,
                     const std::string& place) {
  if (!applies_to_objects(mechanism)) return;
  const auto fits = find_edit(mechanism)->fits_instance;
  std::vector<std::string> on = use.on;
  if (on.empty())
    for (const Instance& i : instances)
      if (fits != nullptr ? fits(i) : !std::holds_alternative<Plane>(i.shape)) on.push_back(i.id);
  for (std::size_t k = 0; k < on.size(); ++k) {
    const auto found =
        std::find_if(instances.begin(), instances.end(), [&](const Instance& i) { return i.id == on[k]; });
    if (found == instances.end())
      throw Error(Exit::data, place + "/on", "nothing here is called \"" + on[k] + "\"", "name an object");
    *found = moved(*found, mechanism, amounts_of(mechanism, use, k, on.size(), place));
  }
}

}  // namespace gonio::scene
