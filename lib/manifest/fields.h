// Field tables: one line per field of a section (JSON name, member, unit, range, sentence) yields reading, validation,
// writing, the JSON Schema and the table in gonio-manifest(5).
#pragma once
#include <functional>
#include <optional>
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
  std::optional<Value> blank;  // is written instead of leaving the field out; where it is null, null may be read

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
  Field& always(Value nothing) {
    blank = std::move(nothing);
    return *this;
  }
  Field& or_null() { return always(Value()); }
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

std::string shown_number(double v);                   // six digits
std::string bounds_text(double lower, double upper);  // "0 to 1", "more than 0", ...; empty: there are none
// Checks the numbers of `value` (also within lists and free parameters) against [lower, upper].
void check_range(const Value& value, double lower, double upper, const std::string& unit, const std::string& place);
void check_choice(const Value& value, const std::vector<std::string>& choices, const std::string& place);
// As a remedy: `did you mean "fx_px"?` for a word near a known one or its stem with another unit, else the list of what
// there is.
std::string remedy_for(const std::string& word, const std::vector<std::string>& known);
[[noreturn]] void unknown_key(const std::string& key, const std::vector<std::string>& known, const std::string& place);
[[noreturn]] void missing_key(const std::string& key, const std::string& sentence, const std::string& place);

// Reads what the table knows; keys that it does not know go to `other(record, key, member, place of the member)`.
template <class Record, class Other>
void read_fields(Record& record, const Value& value, const std::vector<Field<Record>>& fields, const std::string& place,
                 const Other& other) {
  expect_object(value, place);
  for (const auto& [key, member] : value.as_object()) {
    if (key.starts_with("x-")) continue;
    const std::string at = place + "/" + key;
    const Field<Record>* found = nullptr;
    for (const auto& f : fields)
      if (f.name == key) found = &f;
    if (found == nullptr) {
      other(record, key, member, at);
      continue;
    }
    if (member.is_null() && found->blank && found->blank->is_null()) continue;
    found->read(record, member, at);
    check_range(member, found->lower, found->upper, found->unit, at);
    if (!found->choices.empty()) check_choice(member, found->choices, at);
  }
  for (const auto& f : fields)
    if (f.required && value.find(f.name) == nullptr) missing_key(f.name, f.sentence, place);
}

template <class Record>
std::vector<std::string> names_of_fields(const std::vector<Field<Record>>& fields) {
  std::vector<std::string> names;
  for (const auto& f : fields) names.push_back(f.name);
  return names;
}

template <class Record>
Record read_record(const Value& value, const std::vector<Field<Record>>& fields, const std::string& place) {
  Record record;
  read_fields(record, value, fields, place, [&](Record&, const std::string& key, const Value&, const std::string&) {
    unknown_key(key, names_of_fields(fields), place);
  });
  return record;
}

template <class Record>
Value write_record(const Record& record, const std::vector<Field<Record>>& fields) {
  Value out = Value::object();
  for (const auto& f : fields) {
    Value v = f.write(record);
    if (v.is_null() && f.blank)
      out[f.name] = *f.blank;
    else if (!v.is_null())
      out[f.name] = std::move(v);
  }
  return out;
}

// The schema of one field's value with what the table says of it.
Value field_schema(Value schema, const std::vector<std::string>& choices, double lower, double upper, bool or_null);
// An object with these properties, own keys, and no others.
Value object_schema(Value properties, const std::vector<std::string>& required);

template <class Record>
Value properties_of(const std::vector<Field<Record>>& fields) {
  Value properties = Value::object();
  for (const auto& f : fields) {
    Value s = field_schema(f.schema, f.choices, f.lower, f.upper, f.blank && f.blank->is_null());
    s["description"] = f.sentence + (f.unit.empty() ? "" : " [" + f.unit + "]");
    properties[f.name] = std::move(s);
  }
  return properties;
}

template <class Record>
std::vector<std::string> required_of(const std::vector<Field<Record>>& fields) {
  std::vector<std::string> required;
  for (const auto& f : fields)
    if (f.required) required.push_back(f.name);
  return required;
}

// "camera-quality" of camera_quality_fields: the name under which a table stands in the schema.
std::string record_name(std::string table);

template <class Record>
Value record_schema(const std::vector<Field<Record>>& fields) {
  return object_schema(properties_of(fields), required_of(fields));
}

// Declares the table of a section and the codec that follows from it.
#define GONIO_TABLE(TYPE, TABLE)                                    \
  const std::vector<Field<TYPE>>& TABLE();                          \
  template <>                                                       \
  struct Codec<TYPE> {                                              \
    static TYPE read(const Value& value, const std::string& place); \
    static Value write(const TYPE& member);                         \
    static Value schema();                                          \
  }

}  // namespace gonio::manifest
