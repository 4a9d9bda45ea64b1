// A unit is a product of atoms, each with an optional exponent, separated by blanks, dots or slashes.
#include "manifest/units.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "manifest/fields.h"

namespace gonio::manifest {
namespace {

const std::vector<std::string> atoms = {"1", "m", "rad", "sr", "s",  "px", "W",  "J",
                                        "K", "V", "A",   "kg", "Hz", "lx", "cd", "lm"};
constexpr std::array<std::pair<std::string_view, std::string_view>, 13> instead = {{{"deg", "rad"},
                                                                                    {"mrad", "rad"},
                                                                                    {"mm", "m"},
                                                                                    {"um", "m"},
                                                                                    {"nm", "m"},
                                                                                    {"cm", "m"},
                                                                                    {"km", "m"},
                                                                                    {"inch", "m"},
                                                                                    {"ms", "s"},
                                                                                    {"us", "s"},
                                                                                    {"min", "s"},
                                                                                    {"mW", "W"},
                                                                                    {"%", "1"}}};

}  // namespace

void check_column_unit(const std::string& column, const std::string& written, const std::string& place) {
  std::string unit;  // brackets only say how far a slash reaches: W/(m^2 sr)
  std::copy_if(written.begin(), written.end(), std::back_inserter(unit), [](char c) { return c != '(' && c != ')'; });
  std::size_t start = 0;
  while (!unit.empty() && start <= unit.size()) {  // "": a column of names
    const auto end = std::min(unit.find_first_of(" ./*", start), unit.size());
    std::string atom = unit.substr(start, end - start);
    atom = atom.substr(0, atom.find('^'));
    for (const auto& [foreign, si] : instead)
      if (atom == foreign)
        throw Error(Exit::data, place, "unit \"" + unit + "\" is not SI", "convert the column to " + std::string(si));
    if (std::find(atoms.begin(), atoms.end(), atom) == atoms.end())
      throw Error(Exit::data, place, "unit \"" + unit + "\" is not known", remedy_for(atom, atoms));
    start = end + 1;
  }
  const auto underscore = column.rfind('_');
  if (underscore == std::string::npos) return;
  const std::string suffix = column.substr(underscore + 1);
  for (const char* known : {"m", "rad", "s", "px"})
    if (suffix == known && unit != known)
      throw Error(Exit::data, place, "column \"" + column + "\" is in " + unit + ", its name says " + known,
                  "rename or convert the column");
}

}  // namespace gonio::manifest
