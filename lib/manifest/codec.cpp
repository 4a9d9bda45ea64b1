#include "manifest/codec.h"

#include <array>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "manifest/fields.h"

namespace gonio::manifest {
namespace {

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

constexpr double orthonormality_limit = 1e-6;

Mat3 read_matrix(const Value& v, Vec3& translation, const std::string& place) {
  expect_array(v, place);
  if (v.as_array().size() != 4)
    throw Error(Exit::data, place, "has " + std::to_string(v.as_array().size()) + " rows, 4 are needed");
  std::array<std::vector<double>, 4> rows;
  for (std::size_t i = 0; i < 4; ++i) rows[i] = numbers(v.as_array()[i], 4, item(place, i));
  if (rows[3] != std::vector<double>{0, 0, 0, 1})
    throw Error(Exit::data, item(place, 3), "last row is " + shown(v.as_array()[3]),
                "a rigid motion ends in [0, 0, 0, 1]");
  Mat3 r;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) r(static_cast<int>(i), static_cast<int>(j)) = rows[i][j];
  translation = {rows[0][3], rows[1][3], rows[2][3]};
  return r;
}

void check_rotation(const Mat3& r, const std::string& place) {
  const Mat3 g = transposed(r) * r;
  double error = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) error = std::max(error, std::abs(g(i, j) - (i == j)));
  if (!(error <= orthonormality_limit))
    throw Error(Exit::data, place, "rotation is not orthonormal (|R'R - I| = " + number_text(error) + ", limit 1e-6)",
                "re-export with 7 digits");
  const Vec3 a{r(0, 0), r(1, 0), r(2, 0)}, b{r(0, 1), r(1, 1), r(2, 1)}, c{r(0, 2), r(1, 2), r(2, 2)};
  if (dot(cross(a, b), c) < 0)
    throw Error(Exit::data, place, "rotation is left-handed (determinant -1)",
                "a camera or object cannot be mirrored; check the axes");
}

}  // namespace

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
  if (!(std::abs(length - 1) <= orthonormality_limit))
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

Parameter Codec<Parameter>::read(const Value& v, const std::string& place) {
  const auto values = [](const Value& from, const std::string& at) {
    return from.is_number() ? std::vector<double>{Codec<double>::read(from, at)}
                            : Codec<std::vector<double>>::read(from, at);
  };
  if (v.is_number() || v.is_array()) return Parameter(values(v, place));
  if (!v.is_object()) wrong_type(v, "a number, a list of numbers or {\"value\": ..., \"free\": true}", place);
  Parameter p;
  for (const auto& [key, member] : v.as_object()) {
    const std::string at = place + "/" + key;
    if (key == "value")
      p.value = values(member, at);
    else if (key == "free")
      p.free = Codec<bool>::read(member, at);
    else if (key == "min")
      p.min = Codec<double>::read(member, at);
    else if (key == "max")
      p.max = Codec<double>::read(member, at);
    else if (key == "sigma")
      p.sigma = Codec<double>::read(member, at);
    else if (key == "share")
      p.share = Codec<std::string>::read(member, at);
    else if (!key.starts_with("x-"))
      unknown_key(key, {"value", "free", "min", "max", "sigma", "share"}, place);
  }
  if (p.value.empty()) missing_key("value", "where the parameter stands or starts", place);
  for (const double x : p.value)
    if ((p.min && x < *p.min) || (p.max && x > *p.max))
      throw Error(Exit::data, place, "value " + number_text(x) + " lies outside its own min and max");
  if (p.sigma && !(*p.sigma > 0))
    throw Error(Exit::data, place + "/sigma", "is " + number_text(*p.sigma) + ", more than 0 is needed");
  return p;
}
Value Codec<Parameter>::write(const Parameter& p) {
  if (!p.given()) return {};
  const Value value = p.value.size() == 1 ? Value(p.value[0]) : Value(p.value);
  if (!p.free && !p.min && !p.max && !p.sigma && p.share.empty()) return value;
  Value out = Value::object({{"value", value}});
  if (p.free) out["free"] = true;
  if (p.min) out["min"] = *p.min;
  if (p.max) out["max"] = *p.max;
  if (p.sigma) out["sigma"] = *p.sigma;
  if (!p.share.empty()) out["share"] = p.share;
  return out;
}
Value Codec<Parameter>::schema() {
  const Value plain = Value(Value::Array{type_schema("number"), list_schema(1, 16)});
  Value object = Value::object(
      {{"type", "object"},
       {"properties", Value::object({{"value", Value::object({{"oneOf", plain}})},
                                     {"free", type_schema("boolean")},
                                     {"min", type_schema("number")},
                                     {"max", type_schema("number")},
                                     {"sigma", Value::object({{"type", "number"}, {"exclusiveMinimum", 0}})},
                                     {"share", type_schema("string")}})},
       {"patternProperties", Value::object({{"^x-", Value::object()}})},
       {"required", Value(Value::Array{"value"})},
       {"additionalProperties", false}});
  Value all = plain;
  all.push_back(std::move(object));
  return Value::object({{"oneOf", std::move(all)}});
}

namespace {
const std::vector<Field<PoseSigma>>& pose_sigma_fields() {
  static const std::vector<Field<PoseSigma>> table{
      field("rotation_rad", &PoseSigma::rotation_rad, "rad", "one number, or three about the axes of the `to` frame"),
      field("translation_m", &PoseSigma::translation_m, "m", "one number, or three along the axes of the `to` frame")};
  return table;
}
const std::vector<Field<Noise>>& noise_fields() {
  static const std::vector<Field<Noise>> table{
      field("gain", &Noise::gain, "", "photons per unit of value: variance is v / gain + read^2").positive().needed(),
      field("read", &Noise::read, "", "read noise, in units of value").range(0, infinite).needed()};
  return table;
}
}  // namespace

// One number stands for all three axes, on input and on output.
PoseSigma Codec<PoseSigma>::read(const Value& v, const std::string& place) {
  Value spread = v;
  if (spread.is_object())
    for (auto& [key, member] : spread.as_object())
      if (member.is_number()) member = Value(Value::Array{member});
  return read_record(spread, pose_sigma_fields(), place);
}
Value Codec<PoseSigma>::write(const PoseSigma& m) {
  return write_record(m, pose_sigma_fields());
}
Value Codec<PoseSigma>::schema() {
  const Value either = Value::object({{"oneOf", Value(Value::Array{type_schema("number"), list_schema(1, 3)})}});
  return Value::object({{"type", "object"},
                        {"properties", Value::object({{"rotation_rad", either}, {"translation_m", either}})},
                        {"additionalProperties", false}});
}
Noise Codec<Noise>::read(const Value& v, const std::string& place) {
  return read_record(v, noise_fields(), place);
}
Value Codec<Noise>::write(const Noise& m) {
  return write_record(m, noise_fields());
}
Value Codec<Noise>::schema() {
  return record_schema(noise_fields());
}

RigidFields read_rigid(const Value& v, const std::string& place) {
  expect_object(v, place);
  RigidFields out;
  const bool matrix = v.find("matrix") != nullptr;
  for (const auto& [key, member] : v.as_object()) {
    const std::string at = place + "/" + key;
    if (key == "matrix") {
      const Mat3 r = read_matrix(member, out.translation_m, at);
      check_rotation(r, place);
      out.rotation = quaternion_of(r);
    } else if (key == "rotation" && !matrix) {
      out.rotation = Codec<Quaternion>::read(member, at);
    } else if (key == "translation_m" && !matrix) {
      out.translation_m = Codec<Vec3>::read(member, at);
    } else if (key == "sigma") {
      out.sigma = Codec<PoseSigma>::read(member, at);
    } else if (key == "rotation" || key == "translation_m") {
      throw Error(Exit::data, at, "stands beside \"matrix\"", "give one of the two forms");
    } else if (!key.starts_with("x-")) {
      unknown_key(key, {"rotation", "translation_m", "matrix", "sigma"}, place);
    }
  }
  return out;
}
Value write_rigid(const RigidFields& r) {
  Value out = Value::object(
      {{"rotation", Codec<Quaternion>::write(r.rotation)}, {"translation_m", Codec<Vec3>::write(r.translation_m)}});
  if (r.sigma) out["sigma"] = Codec<PoseSigma>::write(*r.sigma);
  return out;
}
Value rigid_schema() {
  const Value row = list_schema(4, 4);
  return Value::object(
      {{"type", "object"},
       {"properties",
        Value::object({{"rotation", list_schema(4, 4)},
                       {"translation_m", list_schema(3, 3)},
                       {"matrix", Value::object({{"type", "array"}, {"items", row}, {"minItems", 4}, {"maxItems", 4}})},
                       {"sigma", Codec<PoseSigma>::schema()}})},
       {"patternProperties", Value::object({{"^x-", Value::object()}})},
       {"additionalProperties", false}});
}

}  // namespace gonio::manifest
