// A mechanism as typed on a command line: ID:NAME=NUMBER,NAME=NUMBER,on=NAME. Quantities take units as elsewhere:
// radius_m=35mm.
#include <sstream>

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "manifest/sections/mechanism_use.h"
#include "scene/mechanisms.h"

namespace gonio::scene {
namespace {

const mechanism::Parameter& parameter_of(const mechanism::Mechanism& mechanism, const std::string& name,
                                         const std::string& place) {
  std::string known;
  for (const mechanism::Parameter& p : mechanism.parameters) {
    if (p.name == name) return p;
    known += (known.empty() ? "" : ", ") + p.name;
  }
  throw Error(Exit::usage, place, mechanism.id + " has no parameter \"" + name + "\"", "it takes " + known);
}

double number_of(const mechanism::Parameter& parameter, const std::string& text, const std::string& place) {
  const double value = parse_in_unit(text, parameter.unit, place);
  if (!(value >= parameter.lower && value <= parameter.upper)) {
    std::ostringstream limits;
    limits << parameter.lower << " to " << parameter.upper << " " << parameter.unit;
    throw Error(Exit::usage, place, parameter.name + " " + text + " is not plausible", "give " + limits.str());
  }
  return value;
}

}  // namespace

std::pair<const mechanism::Mechanism*, manifest::MechanismUse> parse_mechanism(const std::string& text,
                                                                               const std::string& place) {
  const std::size_t colon = text.find(':');
  const std::string id = text.substr(0, colon);
  const mechanism::Mechanism* mechanism = mechanism::find_mechanism(id);
  if (!mechanism)
    throw Error(Exit::usage, place, "there is no mechanism \"" + id + "\"", "gonio-manifest(5) lists them");
  manifest::MechanismUse use;
  std::istringstream items(colon == std::string::npos ? "" : text.substr(colon + 1));
  for (std::string item; std::getline(items, item, ',');) {
    const auto [name, value] = parse_assignment(item, place, "type, say, " + id + ":NAME=VALUE");
    if (name == "on")
      use.on.push_back(value);
    else
      use.parameters[name] = manifest::Parameter(number_of(parameter_of(*mechanism, name, place), value, place));
  }
  return {mechanism, use};
}

}  // namespace gonio::scene
