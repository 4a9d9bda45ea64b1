// glTF containers (scene/exchange/gltf/source.h): glTF 2.0 specification, sections 3.6 and 4.4. Little endian
// throughout.
#include "scene/exchange/gltf/source.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"

namespace gonio::scene::gltf2 {
namespace {

constexpr std::uint32_t magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::array<unsigned char, 4> raw{};
  std::memcpy(raw.data(), bytes.data() + at, 4);
  return raw[0] | raw[1] << 8 | raw[2] << 16 | static_cast<std::uint32_t>(raw[3]) << 24;
}

std::string from_base64(std::string_view text, const Item& uri) {
  std::string bytes;
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0) uri.refuse("is no base64");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held >= 8) bytes.push_back(static_cast<char>(bits >> (held -= 8) & 0xff));
  }
  return bytes;
}

std::string unescaped(const std::string& text, const Item& uri) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    if (i + 2 >= text.size() || !std::isxdigit(static_cast<unsigned char>(text[i + 1])) ||
        !std::isxdigit(static_cast<unsigned char>(text[i + 2])))
      uri.refuse("has a broken % sequence");
    out.push_back(static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16)));
    i += 2;
  }
  return out;
}

struct Component {
  std::size_t bytes = 0;
  double full = 1;  // of normalised values
};

Component component_of(const Item& type) {
  switch (type.count()) {
    case 5120: return {1, 127};
    case 5121: return {1, 255};
    case 5122: return {2, 32767};
    case 5123: return {2, 65535};
    case 5125: return {4, 4294967295.0};
    case 5126: return {4, 1};
    default: type.refuse("is no component type of glTF 2.0");
  }
}

double number_at(const char* p, std::uint64_t type) {
  const auto as = [p]<class T>(T value) {
    std::memcpy(&value, p, sizeof value);
    return static_cast<double>(value);
  };
  static_assert(std::endian::native == std::endian::little);
  switch (type) {
    case 5120: return as(std::int8_t{});
    case 5121: return as(std::uint8_t{});
    case 5122: return as(std::int16_t{});
    case 5123: return as(std::uint16_t{});
    case 5125: return as(std::uint32_t{});
    default: return as(float{});
  }
}

std::size_t columns_of(const Item& type) {
  const std::string name = type.text();
  if (name == "SCALAR") return 1;
  if (name == "VEC2") return 2;
  if (name == "VEC3") return 3;
  if (name == "VEC4") return 4;
  type.refuse("is \"" + name + "\"; only numbers and vectors are read here");
}

}  // namespace

Source::Source(const std::filesystem::path& path) : folder_(path.parent_path()), name_(path.string()) {
  const std::string file = read_file(path);
  std::string_view text = file;
  if (file.size() >= 4 && word(file, 0) == magic) {
    const auto cut = [&] { throw Error(Exit::data, name_, "the binary glTF file is cut off", "copy it anew"); };
    if (file.size() < 20 || word(file, 8) > file.size()) cut();
    if (word(file, 4) != 2) throw Error(Exit::data, name_, "is no glTF of version 2", "export it anew");
    const std::uint64_t length = word(file, 12);
    if (word(file, 16) != json_chunk || 20 + length > file.size()) cut();
    text = std::string_view(file).substr(20, length);
    const std::uint64_t at = 20 + length;
    if (at + 8 <= file.size() && word(file, at + 4) == binary_chunk) {
      if (at + 8 + word(file, at) > file.size()) cut();
      chunk_ = file.substr(at + 8, word(file, at));
    }
  }
  json_ = manifest::parse_json(text, name_);
  const std::string version = root()["asset"]["version"].text();
  if (!version.starts_with("2.")) root()["asset"]["version"].refuse("is " + version + ", 2.0 is read");
}

std::string Source::bytes_of(const Item& uri) const {
  const std::string text = uri.text();
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(";base64,");
    if (comma == std::string::npos) uri.refuse("holds data that are not base64");
    return from_base64(std::string_view(text).substr(comma + 8), uri);
  }
  const std::filesystem::path relative = unescaped(text, uri);
  const bool outside = relative.is_absolute() || text.find(':') != std::string::npos ||
                       std::ranges::find(relative, std::filesystem::path("..")) != relative.end();
  if (outside) uri.refuse("leaves the file's folder", "bring the files together in one folder");
  return read_file(folder_ / relative);
}

std::string_view Source::buffer(const Item& index) const {
  const Item entry = root().named("buffers", index);
  const auto [found, is_new] = buffers_.try_emplace(index.count());
  std::string& bytes = found->second;
  if (is_new) {
    if (entry["uri"].there())
      bytes = bytes_of(entry["uri"]);
    else if (index.count() == 0)
      bytes = chunk_;
  }
  if (bytes.size() < entry["byteLength"].count())
    entry["byteLength"].refuse("is more than the " + std::to_string(bytes.size()) + " bytes that are there");
  return std::string_view(bytes).substr(0, entry["byteLength"].count());
}

std::string_view Source::view(const Item& index) const {
  const Item entry = root().named("bufferViews", index);
  const std::string_view all = buffer(entry["buffer"]);
  const std::uint64_t begin = entry["byteOffset"].count(0), length = entry["byteLength"].count();
  if (begin > all.size() || length > all.size() - begin)
    entry["byteLength"].refuse("leads beyond the end of its buffer of " + std::to_string(all.size()) + " bytes");
  return all.substr(begin, length);
}

void Source::add(const Item& accessor, Numbers& to) const {
  const Item view_entry = root().named("bufferViews", accessor["bufferView"]);
  const std::string_view bytes = view(accessor["bufferView"]);
  const std::uint64_t type = accessor["componentType"].count();
  const Component component = component_of(accessor["componentType"]);
  const std::uint64_t row = component.bytes * to.columns, stride = view_entry["byteStride"].count(row);
  const std::uint64_t begin = accessor["byteOffset"].count(0);
  if (stride < row) view_entry["byteStride"].refuse("is less than one row of " + std::to_string(row) + " bytes");
  if (begin > bytes.size() || bytes.size() - begin < row || (to.rows - 1) > (bytes.size() - begin - row) / stride)
    accessor["count"].refuse("leads beyond the end of its view of " + std::to_string(bytes.size()) + " bytes");
  const bool normalised = accessor["normalized"].flag(false) && type != 5126;
  to.v.resize(to.rows * to.columns);
  for (std::size_t i = 0; i < to.rows; ++i)
    for (std::size_t c = 0; c < to.columns; ++c) {
      const double v = number_at(bytes.data() + begin + i * stride + c * component.bytes, type);
      to.v[i * to.columns + c] = normalised ? std::max(v / component.full, -1.0) : v;
    }
}

void Source::add_sparse(const Item& accessor, Numbers& to) const {
  const Item sparse = accessor["sparse"];
  const std::uint64_t count = sparse["count"].count(), type = sparse["indices"]["componentType"].count();
  const std::size_t wide = component_of(sparse["indices"]["componentType"]).bytes;
  const Component component = component_of(accessor["componentType"]);
  const std::string_view places = view(sparse["indices"]["bufferView"]), values = view(sparse["values"]["bufferView"]);
  const std::uint64_t first = sparse["indices"]["byteOffset"].count(0), from = sparse["values"]["byteOffset"].count(0);
  const std::uint64_t row = component.bytes * to.columns;
  if (first > places.size() || count > (places.size() - first) / wide || from > values.size() ||
      count > (values.size() - from) / row)
    sparse["count"].refuse("leads beyond the end of its views");
  const bool normalised = accessor["normalized"].flag(false);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double place = number_at(places.data() + first + i * wide, type);
    if (!(place >= 0) || place >= static_cast<double>(to.rows))
      sparse["indices"].refuse("names a row that is not there");
    for (std::size_t c = 0; c < to.columns; ++c) {
      const double v =
          number_at(values.data() + from + i * row + c * component.bytes, accessor["componentType"].count());
      to.v[static_cast<std::size_t>(place) * to.columns + c] = normalised ? std::max(v / component.full, -1.0) : v;
    }
  }
}

Numbers Source::accessor(const Item& index) const {
  const Item entry = root().named("accessors", index);
  Numbers numbers;
  numbers.rows = entry["count"].count();
  numbers.columns = columns_of(entry["type"]);
  if (numbers.rows == 0) entry["count"].refuse("is 0");
  if (numbers.rows > (std::uint64_t{1} << 32)) entry["count"].refuse("is more than 2^32");
  if (entry["bufferView"].there()) {
    add(entry, numbers);
  } else {
    if (!entry["sparse"].there()) entry["bufferView"].refuse("is missing", "decompress the file's meshes");
    if (numbers.rows > (std::uint64_t{1} << 26)) entry["count"].refuse("is more than 2^26 rows of zeros");
    numbers.v.assign(numbers.rows * numbers.columns, 0);
  }
  if (entry["sparse"].there()) add_sparse(entry, numbers);
  return numbers;
}

}  // namespace gonio::scene::gltf2
