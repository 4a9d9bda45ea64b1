// Fields that one member pointer does not describe. For the sources of this folder that hold field tables.
#pragma once
#include <functional>
#include <string>

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
    return defined(record_name(#TABLE));                                 \
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

template <class Record>
Field<Record> sigma_field(Sigmas Record::*member) {
  return custom<Record>(
      "sigma", "", "one standard deviation beside each fitted value, under the same key", defined("sigmas"),
      [member](Record& r, const Value& v, const std::string& place) { r.*member = read_sigmas(v, place); },
      [member](const Record& r) { return write_sigmas(r.*member); });
}

}  // namespace gonio::manifest
