// The table of units, and the reader of quantities. A unit is a factor to the SI unit of its dimension.
#include "base/quantity.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/error.h"

namespace gonio {
namespace {

constexpr double degree_rad = 3.14159265358979323846 / 180.0;

struct Unit {
  Dimension dimension;
  std::string_view name;
  double in_si;
};
constexpr std::array units = {
    Unit{Dimension::length, "nm", 1e-9},  Unit{Dimension::length, "um", 1e-6},
    Unit{Dimension::length, "mm", 1e-3},  Unit{Dimension::length, "cm", 1e-2},
    Unit{Dimension::length, "m", 1.0},    Unit{Dimension::angle, "rad", 1.0},
    Unit{Dimension::angle, "mrad", 1e-3}, Unit{Dimension::angle, "deg", degree_rad},
    Unit{Dimension::time, "us", 1e-6},    Unit{Dimension::time, "ms", 1e-3},
    Unit{Dimension::time, "s", 1.0},      Unit{Dimension::time, "min", 60.0},
    Unit{Dimension::time, "h", 3600.0},   Unit{Dimension::pixel, "px", 1.0},
    Unit{Dimension::ratio, "%", 1e-2},
};

struct DimensionName {
  Dimension dimension;
  std::string_view name, si;
};
constexpr std::array dimensions = {
    DimensionName{Dimension::none, "number", ""},    DimensionName{Dimension::length, "length", "m"},
    DimensionName{Dimension::angle, "angle", "rad"}, DimensionName{Dimension::time, "time", "s"},
    DimensionName{Dimension::pixel, "pixels", "px"}, DimensionName{Dimension::ratio, "ratio", ""},
};

const DimensionName& entry(Dimension dimension) {
  for (const auto& d : dimensions)
    if (d.dimension == dimension) return d;
  return dimensions[0];
}

bool unit_is_optional(Dimension dimension) {
  return dimension == Dimension::none || dimension == Dimension::ratio || dimension == Dimension::pixel;
}

std::string remedy_for(Dimension dimension) {
  std::string names;
  for (const auto& unit : units)
    if (unit.dimension == dimension) names += (names.empty() ? "" : ", ") + std::string(unit.name);
  if (dimension == Dimension::none) return "write a plain number, such as 25";
  const std::string what = "write a number" + std::string(unit_is_optional(dimension) ? ", or one" : "");
  return what + " with a unit of " + std::string(entry(dimension).name) + ": " + names;
}

// Factor of `name`, where it is a unit of `dimension`. The micro sign is accepted for u.
std::optional<double> factor(std::string_view name, Dimension dimension) {
  std::string plain(name);
  for (const std::string_view micro : {"\u00b5", "\u03bc"})
    if (plain.starts_with(micro)) plain = "u" + plain.substr(micro.size());
  for (const auto& unit : units)
    if (unit.dimension == dimension && unit.name == plain) return unit.in_si;
  return std::nullopt;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r\n";
  const auto first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

}  // namespace

double parse_quantity(std::string_view text, Dimension dimension, const std::string& place) {
  const std::string shown = "'" + std::string(text) + "'";
  std::string_view rest = trimmed(text);
  if (rest.starts_with('+')) rest.remove_prefix(1);
  double number = 0;
  const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (failure != std::errc() || !std::isfinite(number))
    throw Error(Exit::usage, place, shown + " is not a number", remedy_for(dimension));
  const std::string_view name = trimmed(rest.substr(static_cast<std::size_t>(end - rest.data())));
  if (name.empty()) {
    if (!unit_is_optional(dimension)) throw Error(Exit::usage, place, shown + " lacks its unit", remedy_for(dimension));
    return number;
  }
  const auto scale = factor(name, dimension);
  if (!scale) {
    const std::string problem = shown + " is not a " + std::string(entry(dimension).name);
    throw Error(Exit::usage, place, problem, remedy_for(dimension));
  }
  return number * *scale;
}

double parse_in_unit(std::string_view text, std::string_view unit, const std::string& place) {
  const bool plain = text.find_first_not_of("0123456789.eE+-") == std::string_view::npos;
  const Dimension dimension = plain           ? Dimension::none
                              : unit == "m"   ? Dimension::length
                              : unit == "rad" ? Dimension::angle
                              : unit == "s"   ? Dimension::time
                                              : Dimension::ratio;
  return parse_quantity(text, dimension, place);
}

std::string_view si_unit(Dimension dimension) {
  return entry(dimension).si;
}

std::string_view dimension_name(Dimension dimension) {
  return entry(dimension).name;
}

}  // namespace gonio
