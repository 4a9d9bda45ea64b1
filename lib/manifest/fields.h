// Field tables: one line per field of a section (JSON name, member, unit, range, sentence) yields reading, validation,
// writing, the JSON Schema and the table in gonio-manifest(5).
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "manifest/codec.h"
#include "manifest/value.h"

namespace gonio::manifest {

template <class Record>
struct Field {
  std::string name, unit, sentence;
  bool required = false;
  double lower = -infinite, upper = infinite;
  std::vector<std::string> choices;  // of a text
  Value schema;
  std::function<void(Record&, const Value&, const std::string& place)> read;
  std::function<Value(const Record&)> write;  // null: the field is left out

  Field& range(double low, double high) {
    lower = low;
    upper = high;
    return *this;
  }
  Field& positive() { return range(tiny, infinite); }
  Field& one_of(std::vector<std::string> words) {
    choices = std::move(words);
    return *this;
  }
  Field& needed() {
    required = true;
    return *this;
  }
};

template <class Record, class Member>
Field<Record> field(std::string name, Member Record::*member, std::string unit, std::string sentence) {
  Field<Record> f;
  f.name = std::move(name);
  f.unit = std::move(unit);
  f.sentence = std::move(sentence);
  f.schema = Codec<Member>::schema();
  f.read = [member](Record& r, const Value& v, const std::string& place) { r.*member = Codec<Member>::read(v, place); };
  f.write = [member](const Record& r) { return Codec<Member>::write(r.*member); };
  return f;
}

// Checks the numbers of `value` (also within lists and free parameters) against [lower, upper].
void check_range(const Value& value, double lower, double upper, const std::string& unit, const std::string& place);
void check_choice(const Value& value, const std::vector<std::string>& choices, const std::string& place);
// As a remedy: `did you mean "fx_px"?` for a word near a known one or its stem with another unit, else the list of what
// there is.
std::string remedy_for(const std::string& word, const std::vector<std::string>& known);
[[noreturn]] void unknown_key(const std::string& key, const std::vector<std::string>& known, const std::string& place);
[[noreturn]] void missing_key(const std::string& key, const std::string& sentence, const std::string& place);

template <class Record>
Record read_record(const Value& value, const std::vector<Field<Record>>& fields, const std::string& place) {
  expect_object(value, place);
  Record record;
  for (const auto& [key, member] : value.as_object()) {
    if (key.starts_with("x-")) continue;
    const Field<Record>* found = nullptr;
    for (const auto& f : fields)
      if (f.name == key) found = &f;
    if (found == nullptr) {
      std::vector<std::string> known;
      for (const auto& f : fields) known.push_back(f.name);
      unknown_key(key, known, place);
    }
    const std::string at = place + "/" + key;
    found->read(record, member, at);
    check_range(member, found->lower, found->upper, found->unit, at);
    if (!found->choices.empty()) check_choice(member, found->choices, at);
  }
  for (const auto& f : fields)
    if (f.required && value.find(f.name) == nullptr) missing_key(f.name, f.sentence, place);
  return record;
}

template <class Record>
Value write_record(const Record& record, const std::vector<Field<Record>>& fields) {
  Value out = Value::object();
  for (const auto& f : fields)
    if (Value v = f.write(record); !v.is_null()) out[f.name] = std::move(v);
  return out;
}

template <class Record>
Value record_schema(const std::vector<Field<Record>>& fields) {
  Value properties = Value::object(), required = Value::array();
  for (const auto& f : fields) {
    Value s = f.schema;
    if (!f.choices.empty()) s["enum"] = Value(f.choices);
    if (const Value* type = s.find("type");
        type != nullptr && type->is_string() && (type->as_string() == "number" || type->as_string() == "integer")) {
      if (f.lower == tiny)
        s["exclusiveMinimum"] = 0;
      else if (f.lower > -infinite)
        s["minimum"] = f.lower;
      if (f.upper < infinite) s["maximum"] = f.upper;
    }
    s["description"] = f.sentence + (f.unit.empty() ? "" : " [" + f.unit + "]");
    properties[f.name] = std::move(s);
    if (f.required) required.push_back(f.name);
  }
  Value out = Value::object({{"type", "object"}, {"properties", std::move(properties)}});
  if (!required.as_array().empty()) out["required"] = std::move(required);
  out["patternProperties"]["^x-"] = Value::object();
  out["additionalProperties"] = false;
  return out;
}

}  // namespace gonio::manifest
