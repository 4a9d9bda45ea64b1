// Quantities that people type: `18um`, `7.5deg`, `600ms`, `1%` become SI numbers; a wrong dimension is an error.
#pragma once
#include <string>
#include <string_view>

namespace gonio {

enum class Dimension { none, length, angle, time, pixel, ratio };

// SI value of `text`. length m (nm um mm cm m), angle rad (rad mrad deg), time s (us ms s min h), pixel px,
// ratio 1 (plain number or %), none: plain number. A length, angle or time needs its unit: "25" is refused.
// Throws Error(usage) at `place` naming the units that would do.
double parse_quantity(std::string_view text, Dimension dimension, const std::string& place);

// Of what is measured in `unit`, "m", "rad", "s" or any other: a plain number is in that unit, and one with a unit of
// the same kind is taken to it.
double parse_in_unit(std::string_view text, std::string_view unit, const std::string& place);

std::string_view si_unit(Dimension dimension);       // "m", "rad", "s", "px", "", ""
std::string_view dimension_name(Dimension dimension);  // "length", ...

}  // namespace gonio
