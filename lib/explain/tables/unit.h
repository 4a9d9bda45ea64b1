// Units of columns as files and people write them: "deg", "mm", "1/sr", "W/m^2/sr", "W/(m^2 sr)". A unit is a factor to
// SI and a product of powers of SI's atoms; angles, pixels and solid angles are kept apart so that columns are not
// mixed up. "DN" and "%" are numbers.
#pragma once
#include <map>
#include <string>

namespace gonio::explain::tables {

struct Unit {
  double factor = 1;                  // to SI
  std::map<std::string, int> powers;  // {"m": -2, "W": 1}; empty: a number
  std::string text() const;           // of the SI unit, as the manifest spells it: "W/m^2", "1"
};
// Error(data) at `place` where an atom is not known. "" is a number.
Unit parse_unit(const std::string& text, const std::string& place);

// A column's heading: "theta_i [deg]", "exposure_ms", "f". The unit that it states comes off the name; a unit that was
// part of the name returns as SI's: "exposure_ms" is "exposure_s", its factor 1e-3.
struct Heading {
  std::string name;
  bool has_unit = false;
  Unit unit;
};
Heading parse_heading(const std::string& text, const std::string& place);

// The name without the unit at its end: "exposure_s" -> "exposure"; `unit`, where wanted, receives it ("" for none).
std::string stem_of(const std::string& name, std::string* unit = nullptr);

}  // namespace gonio::explain::tables
