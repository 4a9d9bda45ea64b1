#include "manifest/fields.h"

#include <algorithm>
#include <sstream>

#include "base/error.h"
#include "base/text.h"

namespace gonio::manifest {
namespace {

std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& w : words) out += (out.empty() ? "" : ", ") + w;
  return out;
}

// The part before the unit: "fx" of "fx_mm".
std::string_view stem(std::string_view word) {
  return word.substr(0, word.rfind('_'));
}

std::string number_text(double v) {
  std::ostringstream out;
  out.precision(6);
  out << v;
  return out.str();
}

}  // namespace

std::string remedy_for(const std::string& word, const std::vector<std::string>& known) {
  const auto nearest =
      std::ranges::min_element(known, {}, [&](const std::string& k) { return edit_distance(word, k); });
  if (nearest == known.end()) return "none is known here";
  const bool other_unit = word.find('_') != std::string::npos && stem(word) == stem(*nearest);
  if (other_unit || edit_distance(word, *nearest) <= std::max<std::size_t>(1, word.size() / 3))
    return "did you mean \"" + *nearest + "\"?";
  return "there is " + listed(known);
}

void check_range(const Value& value, double lower, double upper, const std::string& unit, const std::string& place) {
  if (lower == -infinite && upper == infinite) return;
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.as_array().size(); ++i)
      check_range(value.as_array()[i], lower, upper, unit, item(place, i));
  } else if (value.is_object() && value.find("value") != nullptr) {
    check_range(*value.find("value"), lower, upper, unit, place + "/value");
  } else if (value.is_number() && !(value.as_number() >= lower && value.as_number() <= upper)) {
    const std::string with_unit = unit.empty() || unit == "1" ? "" : " " + unit;
    const std::string limit = lower == tiny && upper == infinite ? "more than 0"
                              : upper == infinite
                                  ? number_text(lower) + " or more"
                                  : number_text(lower == tiny ? 0 : lower) + " to " + number_text(upper);
    throw Error(Exit::data, place,
                "is " + number_text(value.as_number()) + with_unit + ", " + limit + with_unit + " is needed");
  }
}

void check_choice(const Value& value, const std::vector<std::string>& choices, const std::string& place) {
  if (value.is_string() && std::ranges::find(choices, value.as_string()) == choices.end())
    throw Error(Exit::data, place, "is \"" + value.as_string() + "\"", remedy_for(value.as_string(), choices));
}

void unknown_key(const std::string& key, const std::vector<std::string>& known, const std::string& place) {
  throw Error(Exit::data, place + "/" + key, "is not a key that gonio knows",
              remedy_for(key, known) + " (own keys start with x-)");
}

void missing_key(const std::string& key, const std::string& sentence, const std::string& place) {
  throw Error(Exit::data, place, "lacks \"" + key + "\" (" + sentence + ")");
}

}  // namespace gonio::manifest
