// A glTF 2.0 file and its buffers: .gltf with buffers beside it or inside as base64, and binary .glb.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "scene/exchange/gltf/item.h"

namespace gonio::scene::gltf2 {

// Numbers of an accessor, row by row. Normalised integers are shares already.
struct Numbers {
  std::size_t rows = 0, columns = 0;
  std::vector<double> v;
};

class Source {
 public:
  explicit Source(const std::filesystem::path& path);  // Error(no_input | data)
  Item root() const { return {&json_, name_, ""}; }
  const std::string& name() const { return name_; }

  // Every index, offset, stride and length is checked against the bytes that are there: Error(data).
  Numbers accessor(const Item& index) const;
  std::string_view view(const Item& index) const;  // of a bufferView
  // The bytes that a URI names: data:...;base64, or a file in the folder of this one or below.
  std::string bytes_of(const Item& uri) const;

 private:
  std::string_view buffer(const Item& index) const;
  void add(const Item& accessor, Numbers& to) const;
  void add_sparse(const Item& accessor, Numbers& to) const;

  std::filesystem::path folder_;
  std::string name_, chunk_;  // chunk: the binary part of a .glb
  manifest::Value json_;
  mutable std::map<std::uint64_t, std::string> buffers_;
};

}  // namespace gonio::scene::gltf2
