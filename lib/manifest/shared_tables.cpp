// Field tables of what many sections share: parameters that a fit may move, rigid motions and their sigmas, noise.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"

namespace gonio::manifest {
namespace {

std::string digits_of(double v) {
  std::ostringstream out;
  out.precision(3);
  out << v;
  return out.str();
}

Value numbers_schema(std::size_t low, std::size_t high) {
  return Value::object({{"type", "array"},
                        {"items", Codec<double>::schema()},
                        {"minItems", std::uint64_t{low}},
                        {"maxItems", std::uint64_t{high}}});
}

// One number, or a list of at least one.
std::vector<double> number_or_numbers(const Value& v, const std::string& place) {
  if (v.is_number()) return {Codec<double>::read(v, place)};
  auto out = Codec<std::vector<double>>::read(v, place);
  if (out.empty()) wrong_type(v, "a number, or a list of at least one,", place);
  return out;
}
Value number_or_numbers(const std::vector<double>& v) {
  return v.size() == 1 ? Value(v[0]) : Value(v);
}
Value::Array number_or_numbers_schema() {
  Value list = Codec<std::vector<double>>::schema();
  list["minItems"] = 1;
  return {Codec<double>::schema(), std::move(list)};
}

constexpr double orthonormality_limit = 1e-6;

Mat3 read_matrix(const Value& v, Vec3& translation, const std::string& place) {
  expect_array(v, place);
  if (v.as_array().size() != 4)
    throw Error(Exit::data, place, "has " + std::to_string(v.as_array().size()) + " rows, 4 are needed");
  std::array<std::vector<double>, 4> rows;
  for (std::size_t i = 0; i < 4; ++i) {
    rows[i] = Codec<std::vector<double>>::read(v.as_array()[i], item(place, i));
    if (rows[i].size() != 4)
      throw Error(Exit::data, item(place, i), "has " + std::to_string(rows[i].size()) + " numbers, 4 are needed");
  }
  if (rows[3] != std::vector<double>{0, 0, 0, 1})
    throw Error(Exit::data, item(place, 3), "last row is " + print_json(v.as_array()[3], -1),
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
    throw Error(Exit::data, place, "rotation is not orthonormal (|R'R - I| = " + digits_of(error) + ", limit 1e-6)",
                "re-export with 7 digits");
  const Vec3 a{r(0, 0), r(1, 0), r(2, 0)}, b{r(0, 1), r(1, 1), r(2, 1)}, c{r(0, 2), r(1, 2), r(2, 2)};
  if (dot(cross(a, b), c) < 0)
    throw Error(Exit::data, place, "rotation is left-handed (determinant -1)",
                "a camera or object cannot be mirrored; check the axes");
}

// One number stands for all three axes.
Field<PoseSigma> axes_field(const char* name, std::vector<double> PoseSigma::*member, const char* unit,
                            const char* sentence) {
  return custom<PoseSigma>(
      name, unit, sentence, defined("axes"),
      [member](PoseSigma& s, const Value& v, const std::string& place) {
        s.*member = number_or_numbers(v, place);
        if ((s.*member).size() != 1 && (s.*member).size() != 3) wrong_type(v, "one number, or three,", place);
      },
      [member](const PoseSigma& s) { return Codec<std::vector<double>>::write(s.*member); });
}

}  // namespace

const std::vector<Field<Parameter>>& parameter_fields() {
  static const std::vector<Field<Parameter>> table{
      custom<Parameter>(
          "value", "", "where it stands or starts: a number, or a list of them",
          Value::object({{"oneOf", Value(number_or_numbers_schema())}}),
          [](Parameter& p, const Value& v, const std::string& place) { p.value = number_or_numbers(v, place); },
          [](const Parameter& p) { return number_or_numbers(p.value); })
          .needed(),
      custom<Parameter>(
          "free", "", "true: a fit may move it", Codec<bool>::schema(),
          [](Parameter& p, const Value& v, const std::string& place) { p.free = Codec<bool>::read(v, place); },
          [](const Parameter& p) { return p.free ? Value(true) : Value(); }),
      field("min", &Parameter::min, "", "a fit goes no lower"),
      field("max", &Parameter::max, "", "a fit goes no higher"),
      field("sigma", &Parameter::sigma, "", "one standard deviation of what is known of it: the width of a prior")
          .positive(),
      field("share", &Parameter::share, "", "free parameters that bear the same one are one parameter")};
  return table;
}

const std::vector<Field<PoseSigma>>& pose_sigma_fields() {
  static const std::vector<Field<PoseSigma>> table{axes_field("rotation_rad", &PoseSigma::rotation_rad, "rad",
                                                              "one number, or three about the axes of the `to` frame"),
                                                   axes_field("translation_m", &PoseSigma::translation_m, "m",
                                                              "one number, or three along the axes of the `to` frame")};
  return table;
}

const std::vector<Field<Noise>>& noise_fields() {
  static const std::vector<Field<Noise>> table{
      field("gain", &Noise::gain, "", "photons per unit of value: variance is v / gain + read^2").positive().needed(),
      field("read", &Noise::read, "", "read noise, in units of value").range(0, infinite).needed()};
  return table;
}

const std::vector<Field<RigidFields>>& rigid_motion_fields() {
  Value matrix = Value::object({{"type", "array"}, {"items", numbers_schema(4, 4)}, {"minItems", 4}, {"maxItems", 4}});
  static const std::vector<Field<RigidFields>> table{
      field("rotation", &RigidFields::rotation, "", "unit quaternion [w, x, y, z]"),
      field("translation_m", &RigidFields::translation_m, "m", "added after the rotation"),
      custom<RigidFields>(
          "matrix", "", "instead of both, on input: 4x4, row by row", std::move(matrix),
          [](RigidFields& r, const Value& v, const std::string& place) {
            const Mat3 rotation = read_matrix(v, r.translation_m, place);
            check_rotation(rotation, place);
            r.rotation = quaternion_of(rotation);
          },
          [](const RigidFields&) { return Value(); }),
      field("sigma", &RigidFields::sigma, "", "one standard deviation of the motion")};
  return table;
}

// A number or a list of them is short for {"value": ...}.
Parameter Codec<Parameter>::read(const Value& v, const std::string& place) {
  if (v.is_number() || v.is_array()) return Parameter(number_or_numbers(v, place));
  if (!v.is_object()) wrong_type(v, "a number, a list of numbers or {\"value\": ..., \"free\": true}", place);
  Parameter p = read_record(v, parameter_fields(), place);
  for (const double x : p.value)
    if ((p.min && x < *p.min) || (p.max && x > *p.max))
      throw Error(Exit::data, place, "value " + digits_of(x) + " lies outside its own min and max");
  return p;
}
Value Codec<Parameter>::write(const Parameter& p) {
  if (!p.given()) return {};
  Value out = write_record(p, parameter_fields());
  return out.as_object().size() == 1 ? out["value"] : out;
}
Value Codec<Parameter>::schema() {
  return defined("parameter");
}
Value parameter_definition() {
  Value::Array forms = number_or_numbers_schema();
  forms.push_back(record_schema(parameter_fields()));
  return Value::object({{"oneOf", Value(std::move(forms))}});
}

Value axes_definition() {
  return Value::object(
      {{"oneOf", Value(Value::Array{Codec<double>::schema(), numbers_schema(1, 1), numbers_schema(3, 3)})}});
}

RigidFields Codec<RigidFields>::read(const Value& v, const std::string& place) {
  expect_object(v, place);
  if (v.find("matrix") != nullptr)
    for (const char* other : {"rotation", "translation_m"})
      if (v.find(other) != nullptr)
        throw Error(Exit::data, place + "/" + other, "stands beside \"matrix\"", "give one of the two forms");
  return read_record(v, rigid_motion_fields(), place);
}
Value Codec<RigidFields>::write(const RigidFields& r) {
  return write_record(r, rigid_motion_fields());
}
Value Codec<RigidFields>::schema() {
  return defined("rigid-motion");
}

GONIO_RECORD(PoseSigma, pose_sigma_fields);
GONIO_RECORD(Noise, noise_fields);

}  // namespace gonio::manifest
