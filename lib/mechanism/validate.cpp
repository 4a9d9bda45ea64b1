#include "mechanism/validate.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/fields.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
namespace {

bool exists(const manifest::Document& d, Target target, const std::string& name) {
  switch (target) {
    case Target::surface: return has_entry(d, "surfaces", name);
    case Target::light: return has_entry(d, "lights", name);
    case Target::camera:
      return has_entry(d, "cameras", name) ||
             std::ranges::any_of(d.images, [&](const manifest::ImageEntry& image) { return image.id == name; });
    case Target::board: return has_entry(d, "boards", name);
    case Target::object: return has_entry(d, "objects", name);
    case Target::scene:
      if (!d.tables.empty() && (name.starts_with("point ") || name.starts_with("ball ")))
        return true;  // of a table of tracks, or of mirror balls
      if (has_entry(d, "volumes", name) || has_entry(d, "clouds", name) || has_entry(d, "prints", name))
        return true;
      if (std::ranges::find(d.images, name, &manifest::ImageEntry::id) != d.images.end()) return true;
      return has_entry(d, "sequences", name.substr(0, name.find('/')));  // "walking/point-7/frame-12"
  }
  return false;
}

std::vector<std::string> ids() {
  std::vector<std::string> out;
  for (const Mechanism* m : all_mechanisms()) out.push_back(m->id);
  return out;
}

std::vector<std::string> known_parameters(const Mechanism& m) {
  std::vector<std::string> out;
  for (const auto& p : m.parameters) out.push_back(p.name);
  return out;
}

}  // namespace

void validate_uses(const manifest::Document& d) {
  for (const auto& [id, use] : d.mechanisms) {
    const std::string at = manifest::place(d, "/mechanisms/" + id);
    const Mechanism* m = find_mechanism(id);
    if (m == nullptr) throw Error(Exit::data, at, "is no mechanism that gonio knows", manifest::remedy_for(id, ids()));
    for (const auto& name : use.on)
      if (!exists(d, m->target, name))
        throw Error(Exit::data, at + "/on", "names \"" + name + "\", which the manifest does not have");
    for (const auto& [name, parameter] : use.parameters) {
      if (std::ranges::find(m->parameters, name, &Parameter::name) == m->parameters.end())
        throw Error(Exit::data, at + "/" + name, "is no parameter of " + id,
                    manifest::remedy_for(name, known_parameters(*m)));
      if (m->lists) {
        if (parameter.value.size() != use.parameters.begin()->second.value.size())
          throw Error(Exit::data, at + "/" + name,
                      "has " + std::to_string(parameter.value.size()) + " numbers, and " +
                          use.parameters.begin()->first + " " +
                          std::to_string(use.parameters.begin()->second.value.size()),
                      "the lists of " + id + " have one length");
        continue;
      }
      if (parameter.value.size() != 1 && parameter.value.size() != use.on.size())
        throw Error(Exit::data, at + "/" + name, "has " + std::to_string(parameter.value.size()) + " numbers",
                    "give one, or one for each name in \"on\"");
    }
  }
}

}  // namespace gonio::mechanism
