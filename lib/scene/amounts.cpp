// See amounts.h.
#include "scene/amounts.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::scene {

using mechanism::Mechanism;

std::string place_of(const std::string& place, const std::string& name) {
  return place + "/" + name;
}

Amounts amounts_of(const Mechanism& mechanism, const manifest::MechanismUse& use, std::size_t index, std::size_t count,
                   const std::string& place) {
  for (const auto& [name, parameter] : use.parameters)
    if (std::none_of(mechanism.parameters.begin(), mechanism.parameters.end(),
                     [&, key = &name](const mechanism::Parameter& p) { return p.name == *key; }))
      throw Error(Exit::data, place_of(place, name), mechanism.id + " has no such parameter", "see gonio-manifest(5)");
  Amounts amounts;
  for (const mechanism::Parameter& p : mechanism.parameters) {
    const auto found = use.parameters.find(p.name);
    if (found == use.parameters.end() || !found->second.given()) {
      amounts.push_back(p.neutral);
      continue;
    }
    const std::vector<double>& value = found->second.value;
    if (value.size() != 1 && value.size() != count)
      throw Error(Exit::data, place_of(place, p.name),
                  std::to_string(value.size()) + " numbers for " + std::to_string(count) + " targets",
                  "give one number, or one per name in \"on\"");
    amounts.push_back(value[value.size() == 1 ? 0 : index]);
  }
  return amounts;
}

std::optional<Amounts> amounts_on(const manifest::Document& document, const Mechanism& mechanism,
                                  const std::string& name) {
  const auto use = document.mechanisms.find(mechanism.id);
  if (use == document.mechanisms.end()) return {};
  const std::vector<std::string>& on = use->second.on;
  const auto place = std::find(on.begin(), on.end(), name);
  if (!on.empty() && place == on.end()) return {};
  return amounts_of(mechanism, use->second, static_cast<std::size_t>(place - on.begin()),
                    std::max<std::size_t>(1, on.size()), manifest::place(document, "/mechanisms/" + mechanism.id));
}

bool neutral(const Mechanism& mechanism, std::span<const double> amounts) {
  for (std::size_t i = 0; i < amounts.size(); ++i)
    if (amounts[i] != mechanism.parameters[i].neutral) return false;
  return true;
}

}  // namespace gonio::scene
