#include "manifest/codec.h"

#include <cmath>
#include <sstream>

#include "base/error.h"

namespace gonio::manifest {
namespace {

constexpr std::string_view definitions = "#/$defs/";

std::string shown(const Value& v) {
  std::string text = print_json(v, -1);
  return text.size() > 40 ? text.substr(0, 37) + "..." : text;
}
std::string number_text(double v) {
  std::ostringstream out;
  out.precision(3);
  out << v;
  return out.str();
}
Value type_schema(const char* type) {
  return Value::object({{"type", type}});
}
Value list_schema(std::size_t low, std::size_t high) {
  return Value::object({{"type", "array"},
                        {"items", type_schema("number")},
                        {"minItems", std::uint64_t{low}},
                        {"maxItems", std::uint64_t{high}}});
}
std::vector<double> numbers(const Value& v, std::size_t count, const std::string& place) {
  auto out = Codec<std::vector<double>>::read(v, place);
  if (out.size() != count)
    throw Error(Exit::data, place,
                "has " + std::to_string(out.size()) + " numbers, " + std::to_string(count) + " are needed");
  return out;
}

}  // namespace

Value defined(const std::string& name) {
  return Value::object({{"$ref", std::string(definitions) + name}});
}
std::string definition_name(const Value& reference) {
  const Value* path = reference.find("$ref");
  return path == nullptr ? "" : path->as_string().substr(definitions.size());
}
Value by_name(Value entry) {
  return Value::object({{"type", "object"},
                        {"patternProperties", Value::object({{"^x-", Value::object()}})},
                        {"additionalProperties", std::move(entry)}});
}

void wrong_type(const Value& value, const std::string& wanted, const std::string& place) {
  throw Error(Exit::data, place, "is " + shown(value) + ", " + wanted + " is needed");
}
void expect_object(const Value& v, const std::string& place) {
  if (!v.is_object()) wrong_type(v, "an object {...}", place);
}
void expect_array(const Value& v, const std::string& place) {
  if (!v.is_array()) wrong_type(v, "a list [...]", place);
}
std::string item(const std::string& place, std::size_t index) {
  return place + "/" + std::to_string(index);
}

bool Codec<bool>::read(const Value& v, const std::string& place) {
  if (!v.is_bool()) wrong_type(v, "true or false", place);
  return v.as_bool();
}
Value Codec<bool>::write(const bool& m) {
  return m;
}
Value Codec<bool>::schema() {
  return type_schema("boolean");
}

std::int64_t Codec<std::int64_t>::read(const Value& v, const std::string& place) {
  if (v.is_integer()) return v.as_integer();
  if (v.is_number() && std::nearbyint(v.as_number()) == v.as_number() && std::abs(v.as_number()) < 9e15)
    return static_cast<std::int64_t>(v.as_number());
  wrong_type(v, "a whole number", place);
}
Value Codec<std::int64_t>::write(const std::int64_t& m) {
  return m;
}
Value Codec<std::int64_t>::schema() {
  return type_schema("integer");
}

int Codec<int>::read(const Value& v, const std::string& place) {
  const std::int64_t n = Codec<std::int64_t>::read(v, place);
  if (n < INT32_MIN || n > INT32_MAX) wrong_type(v, "a whole number below 2^31", place);
  return static_cast<int>(n);
}
Value Codec<int>::write(const int& m) {
  return m;
}
Value Codec<int>::schema() {
  return type_schema("integer");
}

std::uint64_t Codec<std::uint64_t>::read(const Value& v, const std::string& place) {
  const std::int64_t n = Codec<std::int64_t>::read(v, place);
  if (n < 0) wrong_type(v, "a whole number, 0 or more,", place);
  return static_cast<std::uint64_t>(n);
}
Value Codec<std::uint64_t>::write(const std::uint64_t& m) {
  return m;
}
Value Codec<std::uint64_t>::schema() {
  return Value::object({{"type", "integer"}, {"minimum", 0}});
}

double Codec<double>::read(const Value& v, const std::string& place) {
  if (!v.is_number()) wrong_type(v, "a number", place);
  if (!std::isfinite(v.as_number())) wrong_type(v, "a finite number", place);
  return v.as_number();
}
Value Codec<double>::write(const double& m) {
  return m;
}
Value Codec<double>::schema() {
  return type_schema("number");
}

std::string Codec<std::string>::read(const Value& v, const std::string& place) {
  if (!v.is_string()) wrong_type(v, "a text", place);
  return v.as_string();
}
Value Codec<std::string>::write(const std::string& m) {
  return m.empty() ? Value() : Value(m);
}
Value Codec<std::string>::schema() {
  return type_schema("string");
}

Value Codec<Value>::read(const Value& v, const std::string&) {
  return v;
}
Value Codec<Value>::write(const Value& m) {
  return m;
}
Value Codec<Value>::schema() {
  return Value::object();
}

Quaternion Codec<Quaternion>::read(const Value& v, const std::string& place) {
  const auto q = numbers(v, 4, place);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1) <= 1e-6))
    throw Error(Exit::data, place,
                "quaternion [w, x, y, z] has length " + number_text(length) + " (1 within 1e-6 is needed)",
                "normalise it, or re-export with 7 digits");
  return {q[0], q[1], q[2], q[3]};
}
Value Codec<Quaternion>::write(const Quaternion& q) {
  return std::vector<double>{q.w, q.x, q.y, q.z};
}
Value Codec<Quaternion>::schema() {
  return list_schema(4, 4);
}

Vec3 Codec<Vec3>::read(const Value& v, const std::string& place) {
  const auto n = numbers(v, 3, place);
  return {n[0], n[1], n[2]};
}
Value Codec<Vec3>::write(const Vec3& m) {
  return std::vector<double>{m.x, m.y, m.z};
}
Value Codec<Vec3>::schema() {
  return list_schema(3, 3);
}

std::vector<std::string> read_names(const Value& v, const std::string& place) {
  return v.is_string() ? std::vector<std::string>{v.as_string()} : Codec<std::vector<std::string>>::read(v, place);
}

Sigmas read_sigmas(const Value& v, const std::string& place) {
  expect_object(v, place);
  Sigmas out;
  for (const auto& [key, value] : v.as_object()) {
    if (key.starts_with("x-")) continue;
    const std::string at = place + "/" + key;
    const auto numbers = value.is_number() ? std::vector<double>{Codec<double>::read(value, at)}
                                           : Codec<std::vector<double>>::read(value, at);
    for (const double s : numbers)
      if (s < 0) throw Error(Exit::data, at, "is negative", "a standard deviation is 0 or more");
    out[key] = numbers;
  }
  return out;
}
Value write_sigmas(const Sigmas& sigmas) {
  Value out;
  for (const auto& [key, numbers] : sigmas) out[key] = numbers.size() == 1 ? Value(numbers[0]) : Value(numbers);
  return out;
}
}  // namespace gonio::manifest
