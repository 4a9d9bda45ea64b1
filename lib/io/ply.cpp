// PLY meshes (Turk 1994, "The PLY Polygon File Format"). Own code, because coordinates must keep their double
// precision. What it does not do: triangle strips, edges; elements and properties that it does not know and nobody
// asked for are skipped.
#include "io/encode_ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "io/picture.h"
#include "io/ply_header.h"

namespace gonio::io {
namespace {

constexpr std::size_t vertices_at_once = 1 << 14;

// The values of the body one after the other, whatever their encoding.
class Values {
 public:
  Values(std::string_view file, const PlyHeader& header, const std::string& place)
      : rest_(file.substr(header.body)), format_(header.format), place_(place) {}

  void enter(const PlyElement& element) { element_ = &element; }
  void enter_row(std::uint64_t row) { row_ = row; }

  double next(PlyScalar type) { return format_ == PlyFormat::ascii ? next_word() : next_binary(type); }

  std::uint64_t next_count(PlyScalar type, PlyScalar item) {
    const double count = next(type);
    const std::size_t bytes = format_ == PlyFormat::ascii ? 2 : size_of(item);
    if (!(count >= 0) || count != std::floor(count) || count > static_cast<double>(rest_.size() / bytes + 1))
      refuse("has a list of " + shown(count) + " values, more than the file holds");
    return static_cast<std::uint64_t>(count);
  }

  [[noreturn]] void refuse(const std::string& problem) const {
    throw Error(Exit::data, place_,
                "element " + element_->name + " " + std::to_string(row_) + " of " + std::to_string(element_->count) +
                    " " + problem,
                "export or copy it again");
  }

  static std::string shown(double value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
  }

 private:
  double next_word() {
    constexpr std::string_view blank = " \t\r\n";
    const auto first = rest_.find_first_not_of(blank);
    if (first == std::string_view::npos) refuse("is cut off");
    rest_.remove_prefix(first);
    const std::string_view word = rest_.substr(0, std::min(rest_.find_first_of(blank), rest_.size()));
    double value = 0;
    const auto* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto parsed = std::from_chars(begin, word.data() + word.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != word.data() + word.size())
      refuse("has '" + std::string(word.substr(0, 32)) + "' for a number");
    rest_.remove_prefix(word.size());
    return value;
  }

  template <class T>
  T stored() {
    std::array<char, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), rest_.data(), sizeof(T));
    const bool file_is_big = format_ == PlyFormat::big_endian, machine_is_big = std::endian::native == std::endian::big;
    if (file_is_big != machine_is_big) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }

  double next_binary(PlyScalar type) {
    const std::size_t size = size_of(type);
    if (rest_.size() < size) refuse("is cut off");
    double value = 0;
    switch (type) {
      case PlyScalar::int8: value = stored<std::int8_t>(); break;
      case PlyScalar::uint8: value = stored<std::uint8_t>(); break;
      case PlyScalar::int16: value = stored<std::int16_t>(); break;
      case PlyScalar::uint16: value = stored<std::uint16_t>(); break;
      case PlyScalar::int32: value = stored<std::int32_t>(); break;
      case PlyScalar::uint32: value = stored<std::uint32_t>(); break;
      case PlyScalar::float32: value = static_cast<double>(stored<float>()); break;
      case PlyScalar::float64: value = stored<double>(); break;
    }
    rest_.remove_prefix(size);
    return value;
  }

  std::string_view rest_;
  PlyFormat format_;
  const std::string& place_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

void skip(const PlyProperty& property, Values& values) {
  const std::uint64_t count = property.count_type ? values.next_count(*property.count_type, property.type) : 1;
  for (std::uint64_t i = 0; i < count; ++i) values.next(property.type);
}

// What a vertex property means to a mesh: its place among x y z, nx ny nz, s t; -1 for what is not kept.
int vertex_slot(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, int>, 12> slots = {{{"x", 0},
                                                                       {"y", 1},
                                                                       {"z", 2},
                                                                       {"nx", 3},
                                                                       {"ny", 4},
                                                                       {"nz", 5},
                                                                       {"s", 6},
                                                                       {"t", 7},
                                                                       {"u", 6},
                                                                       {"v", 7},
                                                                       {"texture_u", 6},
                                                                       {"texture_v", 7}}};
  for (const auto& [known, slot] : slots)
    if (name == known) return slot;
  return -1;
}

// Places in `wish.properties` that a vertex property fills (a name may be wished for once).
std::vector<int> wished_slots(const PlyElement& element, const PlyWish& wish) {
  std::vector<int> slots;
  for (const auto& p : element.properties) {
    const auto found = std::find(wish.properties.begin(), wish.properties.end(), p.name);
    slots.push_back(p.count_type || found == wish.properties.end() ? -1
                                                                   : static_cast<int>(found - wish.properties.begin()));
  }
  return slots;
}

float kept(const PlyProperty& property, double value) {
  if (property.type != PlyScalar::uint8) return static_cast<float>(value);
  const auto share = static_cast<float>(value / 255);
  const bool colour = property.name == "red" || property.name == "green" || property.name == "blue";
  return colour ? linear_from_srgb(share) : share;
}

void read_vertices(const PlyElement& element, const PlyWish& wish, Values& values, TriangleMesh& mesh) {
  std::vector<int> slots;
  const std::vector<int> wished = wished_slots(element, wish);
  std::array<bool, 8> present{};
  for (const auto& p : element.properties) {
    slots.push_back(p.count_type ? -1 : vertex_slot(p.name));
    if (slots.back() >= 0) present[static_cast<std::size_t>(slots.back())] = true;
  }
  if (!present[0] || !present[1] || !present[2]) values.refuse("lacks x, y or z");
  const bool normals = present[3] && present[4] && present[5], texture = present[6] && present[7];
  mesh.positions_m.reserve(element.count);
  if (normals) mesh.normals.reserve(element.count);
  if (texture) mesh.texture.reserve(element.count);
  mesh.properties.resize(wish.properties.size());
  for (const int slot : wished)
    if (slot >= 0) mesh.properties[static_cast<std::size_t>(slot)].reserve(element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    values.enter_row(row);
    std::array<double, 8> v{};
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const auto& p = element.properties[i];
      if (slots[i] < 0 && wished[i] < 0) {
        skip(p, values);
        continue;
      }
      const double value = values.next(p.type);
      if (!std::isfinite(value)) values.refuse("has " + Values::shown(value) + " for " + p.name);
      if (slots[i] >= 0) v[static_cast<std::size_t>(slots[i])] = value;
      if (wished[i] >= 0) mesh.properties[static_cast<std::size_t>(wished[i])].push_back(kept(p, value));
    }
    mesh.positions_m.push_back({v[0], v[1], v[2]});
    if (normals) mesh.normals.push_back({v[3], v[4], v[5]});
    if (texture) mesh.texture.push_back({v[6], v[7]});
  }
}

// A polygon a b c d ... becomes the fan (a b c), (a c d), ...
void read_polygon(const PlyProperty& property, std::uint64_t vertices, Values& values, TriangleMesh& mesh) {
  const std::uint64_t corners = values.next_count(*property.count_type, property.type);
  if (corners < 3) values.refuse("has " + std::to_string(corners) + " corners");
  std::array<std::uint32_t, 3> fan{};
  for (std::uint64_t i = 0; i < corners; ++i) {
    const double index = values.next(property.type);
    if (!(index >= 0 && index < static_cast<double>(vertices)) || index != std::floor(index))
      values.refuse("names vertex " + Values::shown(index) + ", but there are " + std::to_string(vertices));
    fan[i == 0 ? 0 : i == 1 ? 1 : 2] = static_cast<std::uint32_t>(index);
    if (i < 2) continue;
    mesh.triangles.push_back(fan);
    fan[1] = fan[2];
  }
}

std::int32_t label(const PlyProperty& property, Values& values) {
  const double value = values.next(property.type);
  if (!(std::abs(value) <= 0x7fffffff) || value != std::floor(value))
    values.refuse("has the label " + Values::shown(value) + ", which is no integer of 32 bits");
  return static_cast<std::int32_t>(value);
}

void read_faces(const PlyElement& element, std::uint64_t vertices, const PlyWish& wish, Values& values,
                TriangleMesh& mesh) {
  bool known = false, labelled = false;
  const auto is_polygon = [](const PlyProperty& p) {
    return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
  };
  const auto is_label = [&](const PlyProperty& p) { return wish.labels && !p.count_type && p.name == "label"; };
  for (const auto& p : element.properties) {
    known = known || is_polygon(p);
    labelled = labelled || is_label(p);
  }
  if (!known) values.refuse("lacks the list vertex_indices");
  mesh.triangles.reserve(element.count);
  if (labelled) mesh.labels.reserve(element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    values.enter_row(row);
    std::int32_t of_face = 0;
    for (const auto& p : element.properties) {
      if (is_polygon(p))
        read_polygon(p, vertices, values, mesh);
      else if (is_label(p))
        of_face = label(p, values);
      else
        skip(p, values);
    }
    if (labelled) mesh.labels.resize(mesh.triangles.size(), of_face);
  }
}

template <class T>
void append(std::string& bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

std::string header_of(const TriangleMesh& mesh, const PlyWish& wish) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.positions_m.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\n";
  if (!mesh.normals.empty()) text += "property double nx\nproperty double ny\nproperty double nz\n";
  if (!mesh.texture.empty()) text += "property double s\nproperty double t\n";
  for (std::size_t i = 0; i < mesh.properties.size(); ++i)
    if (!mesh.properties[i].empty()) text += "property float " + wish.properties.at(i) + "\n";
  text += "element face " + std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\n";
  if (!mesh.labels.empty()) text += "property int label\n";
  return text + "end_header\n";
}

}  // namespace

TriangleMesh read_ply(const std::filesystem::path& path, const PlyWish& wish) {
  return parse_ply(read_file(path), path.string(), wish);
}

TriangleMesh parse_ply(std::string_view file, const std::string& place, const PlyWish& wish) {
  const PlyHeader header = read_ply_header(file, place);
  std::uint64_t vertices = 0;
  for (const auto& element : header.elements)
    if (element.name == "vertex" && vertices == 0) vertices = element.count;
  if (vertices == 0) throw Error(Exit::data, place, "the mesh has no vertices", "export it again");
  TriangleMesh mesh;
  Values values(file, header, place);
  for (const auto& element : header.elements) {
    values.enter(element);
    values.enter_row(0);
    if (element.name == "vertex" && mesh.positions_m.empty()) {
      read_vertices(element, wish, values, mesh);
    } else if (element.name == "face") {
      read_faces(element, vertices, wish, values, mesh);
    } else if (!element.properties.empty()) {
      for (std::uint64_t row = 0; row < element.count; ++row) {
        values.enter_row(row);
        for (const auto& p : element.properties) skip(p, values);
      }
    }
  }
  return mesh;
}

std::string encode_ply(const TriangleMesh& mesh, const PlyWish& wish) {
  std::string bytes = header_of(mesh, wish);
  std::string one;  // vertex: all are as long
  const auto append_vertex = [&mesh](std::string& to, std::size_t i) {
    for (int k = 0; k < 3; ++k) append(to, mesh.positions_m[i][k]);
    if (!mesh.normals.empty())
      for (int k = 0; k < 3; ++k) append(to, mesh.normals.at(i)[k]);
    if (!mesh.texture.empty()) {
      append(to, mesh.texture.at(i).x);
      append(to, mesh.texture.at(i).y);
    }
    for (const auto& property : mesh.properties)
      if (!property.empty()) append(to, property.at(i));
  };
  if (!mesh.positions_m.empty()) append_vertex(one, 0);
  const std::size_t first = bytes.size(), count = mesh.positions_m.size();
  bytes.reserve(first + count * one.size() + mesh.triangles.size() * 17);
  bytes.resize(first + count * one.size());
  parallel_for(0, (count + vertices_at_once - 1) / vertices_at_once, [&](std::size_t n) {
    std::string part;
    const std::size_t begin = n * vertices_at_once, end = std::min(count, begin + vertices_at_once);
    part.reserve((end - begin) * one.size());
    for (std::size_t i = begin; i < end; ++i) append_vertex(part, i);
    part.copy(&bytes[first + begin * one.size()], part.size());
  });
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    append(bytes, std::uint8_t{3});
    for (const auto index : mesh.triangles[t]) append(bytes, static_cast<std::int32_t>(index));
    if (!mesh.labels.empty()) append(bytes, mesh.labels.at(t));
  }
  return bytes;
}

void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh, const PlyWish& wish) {
  write_file(path, encode_ply(mesh, wish));
}

}  // namespace gonio::io
