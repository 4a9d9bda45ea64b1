// A value of a glTF file that knows where it stands, so that whatever is wrong with it is said with its place:
// "model.gltf#/accessors/3/count".
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "manifest/value.h"

namespace gonio::scene::gltf2 {

class Item {
 public:
  Item(const manifest::Value* value, std::string file, std::string pointer)
      : value_(value), file_(std::move(file)), pointer_(std::move(pointer)) {}
  bool there() const { return value_ != nullptr; }
  const std::string& pointer() const { return pointer_; }
  std::string place() const { return file_ + "#" + pointer_; }
  const manifest::Value& value() const;  // Error(data) where there is none

  // Members and entries; those that are left out are not there().
  Item operator[](std::string_view key) const;
  Item operator[](std::size_t i) const;  // Error(data) beyond the end
  std::size_t size() const;              // of a list; 0 where it is not there
  std::vector<std::string> keys() const;
  Item named(std::string_view list, const Item& index) const;  // of the root: list[index], index checked

  // Error(data) for another type, NaN, or a number out of bounds.
  double number() const;
  double number(double otherwise) const { return there() ? number() : otherwise; }
  std::uint64_t count() const;  // a whole number of at least 0
  std::uint64_t count(std::uint64_t otherwise) const { return there() ? count() : otherwise; }
  std::string text() const;
  std::string text(std::string_view otherwise) const { return there() ? text() : std::string(otherwise); }
  bool flag(bool otherwise) const;
  std::vector<double> numbers(std::size_t n, std::vector<double> otherwise) const;

  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy = "export the file anew") const;

 private:
  const manifest::Value* value_;  // null: not there
  std::string file_, pointer_;
};

}  // namespace gonio::scene::gltf2
