#include "manifest/value.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"

namespace gonio::manifest {
namespace {

constexpr std::size_t depth_limit = 64;

struct Position {
  std::size_t line = 1, column = 0;
};

// Feeds the parser and knows where it stands; copies share the position.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, Position* position) : at_(at), position_(position) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    const bool new_line = *at_++ == '\n';
    position_->line += new_line ? 1 : 0;
    position_->column = new_line ? 0 : position_->column + 1;
    return *this;
  }
  CountingIterator operator++(int) {
    const CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& o) const { return at_ == o.at_; }

 private:
  const char* at_;
  Position* position_;
};

// Builds a Value from nlohmann's event stream: keeps key order, refuses duplicate keys and deep nesting.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(const std::string& place, const Position& position) : place_(place), position_(position) {}
  bool null() override { return add(Value()); }
  bool boolean(bool v) override { return add(Value(v)); }
  bool number_integer(number_integer_t v) override { return add(Value(std::int64_t{v})); }
  bool number_unsigned(number_unsigned_t v) override {
    if (v > static_cast<std::uint64_t>(INT64_MAX)) return add(Value(static_cast<double>(v)));
    return add(Value(static_cast<std::int64_t>(v)));
  }
  bool number_float(number_float_t v, const string_t& text) override {
    if (!std::isfinite(v)) fail("number " + text + " is not finite", "write a finite number");
    return add(Value(v));
  }
  bool string(string_t& v) override { return add(Value(std::move(v))); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Value::object()); }
  bool start_array(std::size_t) override { return open(Value::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& v) override {
    if (!stack_.back().keys.insert(v).second) fail("key \"" + v + "\" stands twice in one object", "keep one of them");
    stack_.back().key = v;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
    std::string what = e.what();
    if (const auto at = what.find("parse error"); at != std::string::npos) what = what.substr(at);
    throw Error(Exit::data, place_, "is not JSON: " + what);
  }
  Value result;

 private:
  struct Open {  // a container that has not ended yet
    Value value;
    std::set<std::string> keys;
    std::string key;
  };
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const {
    throw Error(
        Exit::data, place_,
        problem + " (line " + std::to_string(position_.line) + ", column " + std::to_string(position_.column) + ")",
        remedy);
  }
  bool open(Value v) {
    if (stack_.size() >= depth_limit) fail("nested deeper than 64 levels", "flatten it");
    stack_.push_back({std::move(v), {}, {}});
    return true;
  }
  bool close() {
    Value v = std::move(stack_.back().value);
    stack_.pop_back();
    return add(std::move(v));
  }
  bool add(Value v) {
    if (stack_.empty()) {
      result = std::move(v);
    } else if (Open& parent = stack_.back(); parent.value.is_array()) {
      parent.value.as_array().push_back(std::move(v));
    } else {
      parent.value.as_object().emplace_back(std::move(parent.key), std::move(v));
    }
    return true;
  }
  const std::string& place_;
  const Position& position_;
  std::vector<Open> stack_;
};

void print_string(const std::string& s, std::string& out) {
  out += nlohmann::json(s).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void print_number(double v, std::string& out) {
  if (!std::isfinite(v)) throw Error(Exit::internal, "manifest", "a number to be written is not finite");
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), v).ptr;
  out.append(text.data(), end);
  const std::string_view written(text.data(), static_cast<std::size_t>(end - text.data()));
  if (written.find_first_of(".e") == std::string_view::npos) out += ".0";  // stays a real number when read again
}

// indent < 0: one line. Arrays of plain values stay on one line at any indent: matrices and rows of tables read well.
void print(const Value& v, int indent, int level, bool sorted, std::string& out) {
  const auto new_line = [&](int at) {
    if (indent >= 0) out.append("\n").append(static_cast<std::size_t>(indent * at), ' ');
  };
  if (v.is_null())
    out += "null";
  else if (v.is_bool())
    out += v.as_bool() ? "true" : "false";
  else if (v.is_integer())
    out += std::to_string(v.as_integer());
  else if (v.is_number())
    print_number(v.as_number(), out);
  else if (v.is_string())
    print_string(v.as_string(), out);
  else if (v.is_array()) {
    const bool flat = std::ranges::none_of(v.as_array(), [](const Value& e) { return e.is_array() || e.is_object(); });
    out += '[';
    bool first = true;
    for (const Value& e : v.as_array()) {
      if (!first) out += flat && indent >= 0 ? ", " : ",";
      if (!flat) new_line(level + 1);
      print(e, indent, level + 1, sorted, out);
      first = false;
    }
    if (!flat && !first) new_line(level);
    out += ']';
  } else {
    std::vector<const Value::Member*> members;
    for (const auto& m : v.as_object()) members.push_back(&m);
    if (sorted) std::ranges::sort(members, {}, [](const Value::Member* m) -> const std::string& { return m->first; });
    out += '{';
    bool first = true;
    for (const auto* m : members) {
      if (!first) out += ',';
      new_line(level + 1);
      print_string(m->first, out);
      out += indent >= 0 ? ": " : ":";
      print(m->second, indent, level + 1, sorted, out);
      first = false;
    }
    if (!first) new_line(level);
    out += '}';
  }
}

}  // namespace

Value::Value(const std::vector<double>& v) : data_(Array(v.begin(), v.end())) {}
Value::Value(const std::vector<std::string>& v) : data_(Array(v.begin(), v.end())) {}

const Value* Value::find(std::string_view key) const {
  if (!is_object()) return nullptr;
  for (const auto& [name, value] : as_object())
    if (name == key) return &value;
  return nullptr;
}

Value& Value::operator[](std::string_view key) {
  if (is_null()) data_ = Object{};
  for (auto& [name, value] : as_object())
    if (name == key) return value;
  as_object().emplace_back(std::string(key), Value());
  return as_object().back().second;
}

void Value::push_back(Value v) {
  if (is_null()) data_ = Array{};
  as_array().push_back(std::move(v));
}

Value parse_json(std::string_view text, const std::string& place) {
  Position position;
  Builder builder(place, position);
  nlohmann::json::sax_parse(CountingIterator(text.data(), &position),
                            CountingIterator(text.data() + text.size(), &position), &builder);
  return std::move(builder.result);
}

std::string print_json(const Value& value, int indent) {
  std::string out;
  print(value, indent, 0, false, out);
  return out;
}

std::string canonical_json(const Value& value) {
  std::string out;
  print(value, -1, 0, true, out);
  return out;
}

}  // namespace gonio::manifest
