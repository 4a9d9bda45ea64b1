#include "manifest/finite_makers.h"

#include <cmath>

namespace gonio::manifest {

Value finite_or_null(double v) {
  return std::isfinite(v) ? Value(v) : Value();
}
double number_or_nan(const Value& v, const std::string& place) {
  return v.is_null() ? not_known : Codec<double>::read(v, place);
}
Value number_or_null_schema() {
  return Value::object({{"type", Value(Value::Array{"number", "null"})}});
}

std::vector<double> read_one_or_more(const Value& v, const std::string& place) {
  if (!v.is_array()) return {number_or_nan(v, place)};
  std::vector<double> out;
  for (std::size_t i = 0; i < v.as_array().size(); ++i) out.push_back(number_or_nan(v.as_array()[i], item(place, i)));
  return out;
}
Value write_one_or_more(const std::vector<double>& numbers) {
  return numbers.size() == 1 ? finite_or_null(numbers[0]) : write_list(numbers);
}
Value write_list(const std::vector<double>& numbers) {
  Value out = Value::array();
  for (const double v : numbers) out.push_back(finite_or_null(v));
  return out;
}
Value list_or_nulls_schema() {
  return Value::object({{"type", "array"}, {"items", number_or_null_schema()}});
}
Value one_or_more_schema() {
  return defined("one-or-more");
}
Value one_or_more_definition() {
  return Value::object({{"oneOf", Value(Value::Array{number_or_null_schema(), list_or_nulls_schema()})}});
}

NamedNumbers read_named_numbers(const Value& v, const std::string& place) {
  expect_object(v, place);
  NamedNumbers out;
  for (const auto& [key, numbers] : v.as_object())
    if (!key.starts_with("x-")) out.emplace_back(key, read_one_or_more(numbers, place + "/" + key));
  return out;
}
Value write_named_numbers(const NamedNumbers& numbers) {
  Value out = Value::object();
  for (const auto& [key, list] : numbers) out[key] = write_one_or_more(list);
  return out;
}
Value named_numbers_definition() {
  return by_name(one_or_more_schema());
}

}  // namespace gonio::manifest
