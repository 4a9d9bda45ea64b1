// Fields of numbers that may be infinite or undefined, which JSON has no word for: null stands for them.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "manifest/field_makers.h"
#include "manifest/sections/explanation.h"

namespace gonio::manifest {

Value finite_or_null(double number);
double number_or_nan(const Value& value, const std::string& place);
Value number_or_null_schema();

// One number or null stands for a list of one.
std::vector<double> read_one_or_more(const Value& value, const std::string& place);
Value write_one_or_more(const std::vector<double>& numbers);
Value write_list(const std::vector<double>& numbers);
Value list_or_nulls_schema();
Value one_or_more_schema();
Value one_or_more_definition();

NamedNumbers read_named_numbers(const Value& value, const std::string& place);
Value write_named_numbers(const NamedNumbers& numbers);
Value named_numbers_definition();  // of {"k1": 0.1, "slip_u_px": [1, null]}

template <class Record>
Field<Record> number_field(std::string name, double Record::*member, std::string unit, std::string sentence) {
  return custom<Record>(
             std::move(name), std::move(unit), std::move(sentence), number_or_null_schema(),
             [member](Record& r, const Value& v, const std::string& place) { r.*member = number_or_nan(v, place); },
             [member](const Record& r) { return finite_or_null(r.*member); })
      .or_null();
}

template <class Record>
Field<Record> numbers_by_name(std::string name, NamedNumbers Record::*member, std::string sentence) {
  return custom<Record>(
      std::move(name), "", std::move(sentence), defined("numbers-by-name"),
      [member](Record& r, const Value& v, const std::string& place) { r.*member = read_named_numbers(v, place); },
      [member](const Record& r) { return write_named_numbers(r.*member); });
}

}  // namespace gonio::manifest
