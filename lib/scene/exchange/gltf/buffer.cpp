// See buffer.h.
#include "scene/exchange/gltf/buffer.h"

#include <algorithm>
#include <limits>

namespace gonio::scene::gltf2 {
namespace {

using manifest::Value;

constexpr int vertex_target = 34962, index_target = 34963, no_target = 0;

void add_bounds(const std::vector<float>& values, std::size_t columns, Value& entry) {
  std::vector<double> low(columns, std::numeric_limits<double>::infinity()), high(columns, -low[0]);
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i % columns] = std::min<double>(low[i % columns], values[i]);
    high[i % columns] = std::max<double>(high[i % columns], values[i]);
  }
  entry["min"] = Value(low);
  entry["max"] = Value(high);
}

void add_word(std::string& bytes, std::size_t value) {
  for (int k = 0; k < 4; ++k) bytes += static_cast<char>(value >> (8 * k) & 255u);
}

}  // namespace

int Buffer::vertices(std::span<const double> values, int columns, bool bounds) {
  return numbers(values, columns, bounds, vertex_target);
}

int Buffer::samples(std::span<const double> values, int columns, bool bounds) {
  return numbers(values, columns, bounds, no_target);
}

int Buffer::numbers(std::span<const double> values, int columns, bool bounds, int target) {
  static constexpr std::array<const char*, 5> types{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  const std::vector<float> single(values.begin(), values.end());
  Value entry = Value::object({{"bufferView", view(single.data(), 4 * single.size(), target)},
                               {"componentType", 5126},
                               {"count", static_cast<std::int64_t>(single.size()) / columns},
                               {"type", types.at(static_cast<std::size_t>(columns))}});
  if (bounds) add_bounds(single, static_cast<std::size_t>(columns), entry);
  return enter(std::move(entry));
}

int Buffer::indices(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  return enter(Value::object({{"bufferView", view(triangles.data(), 12 * triangles.size(), index_target)},
                              {"componentType", 5125},
                              {"count", static_cast<std::int64_t>(3 * triangles.size())},
                              {"type", "SCALAR"}}));
}

void Buffer::describe(Value& root, const std::string& uri) const {
  if (bytes_.empty()) return;
  root["accessors"] = accessors_;
  root["bufferViews"] = views_;
  Value buffer = Value::object();
  if (!uri.empty()) buffer["uri"] = uri;
  buffer["byteLength"] = static_cast<std::int64_t>(bytes_.size());
  root["buffers"].push_back(std::move(buffer));
}

int Buffer::view(const void* data, std::size_t length, int target) {
  Value entry = Value::object({{"buffer", 0},
                               {"byteOffset", static_cast<std::int64_t>(bytes_.size())},
                               {"byteLength", static_cast<std::int64_t>(length)}});
  if (target != no_target) entry["target"] = target;
  views_.push_back(std::move(entry));
  bytes_.append(static_cast<const char*>(data), length);
  return static_cast<int>(views_.as_array().size()) - 1;
}

int Buffer::enter(Value entry) {
  accessors_.push_back(std::move(entry));
  return static_cast<int>(accessors_.as_array().size()) - 1;
}

// Chunks begin at multiples of four bytes: JSON is filled with spaces, numbers with zeros.
std::string binary_file(const Value& root, const std::string& bytes) {
  std::string json = manifest::print_json(root, -1), chunk = bytes;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
  std::string file = "glTF";
  add_word(file, 2);
  add_word(file, 12 + 8 + json.size() + (chunk.empty() ? 0 : 8 + chunk.size()));
  add_word(file, json.size());
  file += "JSON" + json;
  if (chunk.empty()) return file;
  add_word(file, chunk.size());
  return file + std::string("BIN\0", 4) + chunk;
}

}  // namespace gonio::scene::gltf2
