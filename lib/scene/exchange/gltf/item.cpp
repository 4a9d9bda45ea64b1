#include "scene/exchange/gltf/item.h"

#include <cmath>

#include "base/error.h"

namespace gonio::scene::gltf2 {

void Item::refuse(const std::string& problem, const std::string& remedy) const {
  throw Error(Exit::data, place(), problem, remedy);
}

const manifest::Value& Item::value() const {
  if (!value_) refuse("is missing");
  return *value_;
}

Item Item::operator[](std::string_view key) const {
  const manifest::Value* found = nullptr;
  if (value_) {
    if (!value_->is_object()) refuse("is no object");
    found = value_->find(key);
  }
  return {found, file_, pointer_ + "/" + std::string(key)};
}

Item Item::operator[](std::size_t i) const {
  if (i >= size()) refuse("has no entry " + std::to_string(i));
  return {&value_->as_array()[i], file_, pointer_ + "/" + std::to_string(i)};
}

std::size_t Item::size() const {
  if (!value_) return 0;
  if (!value_->is_array()) refuse("is no list");
  return value_->as_array().size();
}

std::vector<std::string> Item::keys() const {
  std::vector<std::string> names;
  if (!value_) return names;
  if (!value_->is_object()) refuse("is no object");
  for (const auto& [key, value] : value_->as_object()) names.push_back(key);
  return names;
}

Item Item::named(std::string_view list, const Item& index) const {
  const Item all = (*this)[list];
  const std::uint64_t i = index.count();
  if (i >= all.size())
    index.refuse("is " + std::to_string(i) + ", there are " + std::to_string(all.size()) + " " + std::string(list));
  return all[i];
}

double Item::number() const {
  constexpr double largest = 1e30;  // so that products of a few stay finite
  if (!value().is_number() || !(std::abs(value_->as_number()) <= largest)) refuse("is no number within 1e30");
  return value_->as_number();
}

std::uint64_t Item::count() const {
  const double v = number();
  if (!(v >= 0) || v != std::floor(v) || v > 9007199254740992.0) refuse("is no whole number of at least 0");
  return static_cast<std::uint64_t>(v);
}

std::string Item::text() const {
  if (!value().is_string()) refuse("is no text");
  return value_->as_string();
}

bool Item::flag(bool otherwise) const {
  if (!there()) return otherwise;
  if (!value_->is_bool()) refuse("is neither true nor false");
  return value_->as_bool();
}

std::vector<double> Item::numbers(std::size_t n, std::vector<double> otherwise) const {
  if (!there()) return otherwise;
  if (size() != n) refuse("has " + std::to_string(size()) + " numbers, " + std::to_string(n) + " are needed");
  std::vector<double> all;
  for (std::size_t i = 0; i < n; ++i) all.push_back((*this)[i].number());
  return all;
}

}  // namespace gonio::scene::gltf2
