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

// "number", "integer", or one of both beside "null".
bool speaks_of_numbers(const Value& type) {
  if (type.is_string()) return type.as_string() == "number" || type.as_string() == "integer";
  return type.is_array() && std::ranges::any_of(type.as_array(), speaks_of_numbers);
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

std::string shown_number(double v) {
  std::ostringstream out;
  out.precision(6);
  out << v;
  return out.str();
}

std::string bounds_text(double lower, double upper) {
  if (lower > -infinite && upper < infinite)
    return shown_number(lower == tiny ? 0 : lower) + " to " + shown_number(upper);
  if (upper < infinite) return "at most " + shown_number(upper);
  if (lower == tiny) return "more than 0";
  return lower > -infinite ? shown_number(lower) + " or more" : "";
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
    throw Error(Exit::data, place,
                "is " + shown_number(value.as_number()) + with_unit + ", " + bounds_text(lower, upper) + with_unit +
                    " is needed");
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

Value field_schema(Value schema, const std::vector<std::string>& choices, double lower, double upper, bool or_null) {
  if (!choices.empty()) schema["enum"] = Value(choices);
  const Value* type = schema.find("type");
  if (type != nullptr && type->is_string() && type->as_string() == "array" && schema.find("items") != nullptr) {
    schema["items"] = field_schema(*schema.find("items"), {}, lower, upper, false);
  } else if (type != nullptr && speaks_of_numbers(*type)) {
    if (lower == tiny)
      schema["exclusiveMinimum"] = 0;
    else if (lower > -infinite)
      schema["minimum"] = lower;
    if (upper < infinite) schema["maximum"] = upper;
  }
  type = schema.find("type");
  if (!or_null || (type != nullptr && type->is_array())) return schema;  // which has null among its types
  return Value::object({{"oneOf", Value(Value::Array{std::move(schema), Value::object({{"type", "null"}})})}});
}

Value object_schema(Value properties, const std::vector<std::string>& required) {
  Value out = Value::object({{"type", "object"}, {"properties", std::move(properties)}});
  if (!required.empty()) out["required"] = Value(required);
  out["patternProperties"]["^x-"] = Value::object();
  out["additionalProperties"] = false;
  return out;
}

std::string record_name(std::string table) {
  std::ranges::replace(table, '_', '-');
  return table.substr(0, table.rfind('-'));
}

void missing_key(const std::string& key, const std::string& sentence, const std::string& place) {
  throw Error(Exit::data, place, "lacks \"" + key + "\" (" + sentence + ")");
}

}  // namespace gonio::manifest
