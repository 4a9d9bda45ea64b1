// See unit.h.
#include "explain/tables/unit.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <numbers>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geom/angle.h"
#include "manifest/fields.h"

namespace gonio::explain::tables {
namespace {

struct Atom {
  std::string_view name, si;
  double factor;
};
constexpr std::array<Atom, 42> atoms = {
    {{"1", "", 1},           {"", "", 1},       {"%", "", 0.01},  {"DN", "", 1},      {"count", "", 1},
     {"counts", "", 1},      {"e", "", 1},      {"m", "m", 1},    {"mm", "m", 1e-3},  {"um", "m", 1e-6},
     {"nm", "m", 1e-9},      {"cm", "m", 1e-2}, {"km", "m", 1e3}, {"rad", "rad", 1},  {"mrad", "rad", 1e-3},
     {"deg", "rad", degree}, {"sr", "sr", 1},   {"s", "s", 1},    {"ms", "s", 1e-3},  {"us", "s", 1e-6},
     {"ns", "s", 1e-9},      {"min", "s", 60},  {"h", "s", 3600}, {"px", "px", 1},    {"W", "W", 1},
     {"mW", "W", 1e-3},      {"uW", "W", 1e-6}, {"J", "J", 1},    {"K", "K", 1},      {"mK", "K", 1e-3},
     {"V", "V", 1},          {"mV", "V", 1e-3}, {"A", "A", 1},    {"mA", "A", 1e-3},  {"uA", "A", 1e-6},
     {"kg", "kg", 1},        {"g", "kg", 1e-3}, {"Hz", "Hz", 1},  {"kHz", "Hz", 1e3}, {"lx", "lx", 1},
     {"cd", "cd", 1},        {"lm", "lm", 1}}};
// That may end a column's name. "min" and "h" are left out: theta_min is no time.
constexpr std::array<std::string_view, 16> endings = {"m",   "mm", "um", "nm", "cm", "km", "rad", "mrad",
                                                      "deg", "s",  "ms", "us", "px", "K",  "sr",  "W"};

const Atom& atom_of(const std::string& name, const std::string& unit, const std::string& place) {
  const auto found = std::find_if(atoms.begin(), atoms.end(), [&](const Atom& a) { return a.name == name; });
  if (found != atoms.end()) return *found;
  std::vector<std::string> known;
  for (const Atom& a : atoms)
    if (!a.name.empty()) known.emplace_back(a.name);
  throw Error(Exit::data, place, "unit \"" + unit + "\" is not known", manifest::remedy_for(name, known));
}

double integer_power(double base, int power) {
  double result = 1;
  for (int k = 0; k < std::abs(power); ++k) result *= base;
  return power < 0 ? 1 / result : result;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

std::string Unit::text() const {
  std::string above, below;
  for (const auto& [atom, power] : powers) {
    const std::string raised = atom + (std::abs(power) == 1 ? "" : "^" + std::to_string(std::abs(power)));
    if (power > 0)
      above += (above.empty() ? "" : " ") + raised;
    else
      below += "/" + raised;
  }
  return (above.empty() ? "1" : above) + below;
}

Unit parse_unit(const std::string& text, const std::string& place) {
  Unit unit;
  bool below = false, in_brackets = false, after_atom = false;
  std::size_t at = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (std::string_view(" .*/()").find(c) != std::string_view::npos) {
      if (c == '/')
        below = true;
      else if (c == ')' || (after_atom && !in_brackets))
        below = false;
      in_brackets = c == '(' || (in_brackets && c != ')');
      after_atom = false;
      ++at;
      continue;
    }
    const std::size_t end = std::min(text.find_first_of(" .*/()", at), text.size());
    std::string name = text.substr(at, end - at);
    int power = 1;
    if (const auto hat = name.find('^'); hat != std::string::npos) {
      const auto [stop, failure] = std::from_chars(name.data() + hat + 1, name.data() + name.size(), power);
      if (failure != std::errc() || stop != name.data() + name.size() || std::abs(power) > 9)
        throw Error(Exit::data, place, "unit \"" + text + "\" has an exponent that is no small integer");
      name.resize(hat);
    }
    const Atom& atom = atom_of(name, text, place);
    const int signed_power = below ? -power : power;
    unit.factor *= integer_power(atom.factor, signed_power);
    if (!atom.si.empty() && (unit.powers[std::string(atom.si)] += signed_power) == 0)
      unit.powers.erase(std::string(atom.si));
    at = end;
    after_atom = true;
  }
  return unit;
}

std::string stem_of(const std::string& name, std::string* unit) {
  if (unit != nullptr) unit->clear();
  const auto underscore = name.rfind('_');
  if (underscore == std::string::npos || underscore == 0) return name;
  const std::string_view end = std::string_view(name).substr(underscore + 1);
  if (std::find(endings.begin(), endings.end(), end) == endings.end()) return name;
  if (unit != nullptr) *unit = end;
  return name.substr(0, underscore);
}

Heading parse_heading(const std::string& text, const std::string& place) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const auto start = text.find(open);
    if (start == std::string::npos || !text.ends_with(close)) continue;
    return {trimmed(text.substr(0, start)), true, parse_unit(text.substr(start + 1, text.size() - start - 2), place)};
  }
  std::string ending;
  const std::string stem = stem_of(text, &ending);
  if (ending.empty()) return {text, false, {}};
  const Unit unit = parse_unit(ending, place);
  return {stem + "_" + unit.text(), true, unit};
}

}  // namespace gonio::explain::tables
