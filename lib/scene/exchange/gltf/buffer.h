// The numbers of a glTF file that is being written, and what says where among them things are: sections 3.6 and 4.4 of
// the specification (formats/gltf.cpp). Single precision, little endian.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "manifest/value.h"

namespace gonio::scene::gltf2 {

class Buffer {
 public:
  // Places among the accessors. `columns`: 1 to 4.
  int vertices(std::span<const double> values, int columns, bool bounds);
  int indices(const std::vector<std::array<std::uint32_t, 3>>& triangles);
  int samples(std::span<const double> values, int columns, bool bounds);  // of an animation

  const std::string& bytes() const { return bytes_; }
  // Accessors, views and the one buffer; an empty `uri`: the chunk of a binary file.
  void describe(manifest::Value& root, const std::string& uri) const;

 private:
  int numbers(std::span<const double> values, int columns, bool bounds, int target);
  int view(const void* data, std::size_t length, int target);
  int enter(manifest::Value entry);

  std::string bytes_;
  manifest::Value views_ = manifest::Value::array(), accessors_ = manifest::Value::array();
};

// A file of one piece: JSON and the bytes that it describes without a uri.
std::string binary_file(const manifest::Value& root, const std::string& bytes);

}  // namespace gonio::scene::gltf2
