// A JSON value: what the pages, plans and field tables are made of. nlohmann-json parses and prints it in value.cpp; no
// other source sees that library. Objects keep the order in which keys were written.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gonio::manifest {

class Value {
 public:
  using Array = std::vector<Value>;
  using Member = std::pair<std::string, Value>;
  using Object = std::vector<Member>;

  Value() = default;  // null
  Value(bool v) : data_(v) {}
  Value(int v) : data_(std::int64_t{v}) {}
  Value(std::int64_t v) : data_(v) {}
  Value(std::uint64_t v) : data_(static_cast<std::int64_t>(v)) {}
  Value(double v) : data_(v) {}
  Value(const char* v) : data_(std::string(v)) {}
  Value(std::string v) : data_(std::move(v)) {}
  Value(std::string_view v) : data_(std::string(v)) {}
  Value(Array v) : data_(std::move(v)) {}
  Value(const std::vector<double>& v);
  Value(const std::vector<std::string>& v);
  static Value array() { return Value(Array{}); }
  static Value object() {
    Value v;
    v.data_ = Object{};
    return v;
  }
  static Value object(Object members) {
    Value v;
    v.data_ = std::move(members);
    return v;
  }

  bool is_null() const { return std::holds_alternative<std::monostate>(data_); }
  bool is_bool() const { return std::holds_alternative<bool>(data_); }
  bool is_integer() const { return std::holds_alternative<std::int64_t>(data_); }
  bool is_number() const { return is_integer() || std::holds_alternative<double>(data_); }
  bool is_string() const { return std::holds_alternative<std::string>(data_); }
  bool is_array() const { return std::holds_alternative<Array>(data_); }
  bool is_object() const { return std::holds_alternative<Object>(data_); }

  bool as_bool() const { return std::get<bool>(data_); }
  std::int64_t as_integer() const { return std::get<std::int64_t>(data_); }
  double as_number() const { return is_integer() ? static_cast<double>(as_integer()) : std::get<double>(data_); }
  const std::string& as_string() const { return std::get<std::string>(data_); }
  const Array& as_array() const { return std::get<Array>(data_); }
  Array& as_array() { return std::get<Array>(data_); }
  const Object& as_object() const { return std::get<Object>(data_); }
  Object& as_object() { return std::get<Object>(data_); }

  const Value* find(std::string_view key) const;  // null pointer where there is none or this is no object
  Value& operator[](std::string_view key);        // of an object (null becomes one): found, or appended as null
  void push_back(Value v);                        // onto an array (null becomes one)
  bool operator==(const Value&) const = default;

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Object> data_;
};

// Strict JSON (UTF-8, no duplicate keys, no NaN, depth at most 64). Error(data) at `place` with line and column.
Value parse_json(std::string_view text, const std::string& place);
// Shortest digits that read back to the same double. indent < 0: one line. NaN and infinities are refused:
// Error(internal).
std::string print_json(const Value& value, int indent = 1);
// One line, keys sorted: the form that content ids are computed from.
std::string canonical_json(const Value& value);

}  // namespace gonio::manifest
