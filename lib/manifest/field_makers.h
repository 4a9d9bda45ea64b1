// Fields that one member pointer does not describe. For the sources of this folder that hold field tables.
#pragma once
#include <functional>
#include <string>

#include "base/error.h"
#include "manifest/section_tables.h"

namespace gonio::manifest {

// The codec of a section whose table is defined in the same source.
#define GONIO_RECORD(TYPE, TABLE)                                        \
  TYPE Codec<TYPE>::read(const Value& value, const std::string& place) { \
    return read_record(value, TABLE(), place);                           \
  }                                                                      \
  Value Codec<TYPE>::write(const TYPE& member) {                         \
    return write_record(member, TABLE());                                \
  }                                                                      \
  Value Codec<TYPE>::schema() {                                          \
    return record_schema(TABLE());                                       \
  }                                                                      \
  static_assert(true)  // so that a semicolon follows

template <class Record>
Field<Record> custom(std::string name, std::string unit, std::string sentence, Value schema,
                     std::function<void(Record&, const Value&, const std::string&)> read,
                     std::function<Value(const Record&)> write) {
  Field<Record> f;
  f.name = std::move(name);
  f.unit = std::move(unit);
  f.sentence = std::move(sentence);
  f.schema = std::move(schema);
  f.read = std::move(read);
  f.write = std::move(write);
  return f;
}

// A number stands for a list of one in "sigma": {"fx_px": 0.6}.
template <class Record>
Field<Record> sigma_field(Sigmas Record::*member) {
  return custom<Record>(
      "sigma", "", "one standard deviation beside each fitted value, under the same key", Codec<Value>::schema(),
      [member](Record& r, const Value& v, const std::string& place) {
        expect_object(v, place);
        for (const auto& [key, value] : v.as_object()) {
          const std::string at = place + "/" + key;
          const auto numbers = value.is_number() ? std::vector<double>{Codec<double>::read(value, at)}
                                                 : Codec<std::vector<double>>::read(value, at);
          for (const double s : numbers)
            if (s < 0) throw Error(Exit::data, at, "is negative", "a standard deviation is 0 or more");
          (r.*member)[key] = numbers;
        }
      },
      [member](const Record& r) {
        if ((r.*member).empty()) return Value();
        Value out = Value::object();
        for (const auto& [key, numbers] : r.*member)
          out[key] = numbers.size() == 1 ? Value(numbers[0]) : Value(numbers);
        return out;
      });
}

}  // namespace gonio::manifest
