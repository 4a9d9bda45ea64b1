// See mat_file.h. Inflation by canonical Huffman codes, bit by bit (after Adler's puff.c): slow, and short.
#include "explain/nrsfm/tracks/mat_file.h"

#include <cstdint>
#include <cstdio>
#include <cstring>

#include "base/atomic_file.h"

namespace gonio::tests {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::runtime_error("MAT-file: " + what);
}

class Inflater {
 public:
  explicit Inflater(const std::string& data) : in_(data), at_(2) {
    if (data.size() < 6 || (static_cast<unsigned char>(data[0]) & 15) != 8) refuse("compression is not zlib's");
  }
  std::string run() {
    for (bool last = false; !last;) {
      last = bits(1) != 0;
      const unsigned kind = bits(2);
      if (kind == 0)
        stored();
      else if (kind == 1)
        coded(fixed_lengths(), std::vector<unsigned>(30, 5));
      else if (kind == 2)
        dynamic();
      else
        refuse("a compressed block of no known kind");
    }
    return out_;
  }

 private:
  struct Code {
    std::vector<unsigned> count = std::vector<unsigned>(16), symbol;
    explicit Code(const std::vector<unsigned>& length) : symbol(length.size()) {
      for (const unsigned l : length) ++count[l];
      std::vector<unsigned> first(16);
      for (unsigned l = 1; l < 15; ++l) first[l + 1] = first[l] + count[l];
      for (unsigned s = 0; s < length.size(); ++s)
        if (length[s] != 0) symbol[first[length[s]]++] = s;
      count[0] = 0;
    }
  };
  static std::vector<unsigned> fixed_lengths() {
    std::vector<unsigned> l(288, 8);
    for (unsigned s = 144; s < 256; ++s) l[s] = 9;
    for (unsigned s = 256; s < 280; ++s) l[s] = 7;
    return l;
  }
  unsigned bits(unsigned n) {
    while (held_ < n) {
      if (at_ >= in_.size()) refuse("compressed data end early");
      hold_ |= static_cast<std::uint64_t>(static_cast<unsigned char>(in_[at_++])) << held_;
      held_ += 8;
    }
    const auto value = static_cast<unsigned>(hold_ & ((1ull << n) - 1));
    hold_ >>= n;
    held_ -= n;
    return value;
  }
  unsigned decode(const Code& code) {
    unsigned value = 0, first = 0, index = 0;
    for (unsigned l = 1; l <= 15; ++l) {
      value |= bits(1);
      if (value < first + code.count[l]) return code.symbol[index + value - first];
      index += code.count[l];
      first = (first + code.count[l]) << 1;
      value <<= 1;
    }
    refuse("a code that is none");
  }
  void stored() {
    hold_ = 0, held_ = 0;
    if (at_ + 4 > in_.size()) refuse("compressed data end early");
    const std::size_t n = static_cast<unsigned char>(in_[at_]) + 256u * static_cast<unsigned char>(in_[at_ + 1]);
    at_ += 4;
    if (at_ + n > in_.size()) refuse("compressed data end early");
    out_.append(in_, at_, n);
    at_ += n;
  }
  void dynamic() {
    static const unsigned order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    const unsigned literals = bits(5) + 257, distances = bits(5) + 1, codes = bits(4) + 4;
    std::vector<unsigned> lengths(19);
    for (unsigned i = 0; i < codes; ++i) lengths[order[i]] = bits(3);
    const Code of_lengths(lengths);
    lengths.clear();
    while (lengths.size() < literals + distances) {
      const unsigned s = decode(of_lengths);
      if (s < 16) {
        lengths.push_back(s);
        continue;
      }
      if (s == 16 && lengths.empty()) refuse("a repetition of nothing");
      const unsigned value = s == 16 ? lengths.back() : 0;
      const unsigned times = s == 16 ? 3 + bits(2) : s == 17 ? 3 + bits(3) : 11 + bits(7);
      lengths.insert(lengths.end(), times, value);
    }
    if (lengths.size() != literals + distances) refuse("too many code lengths");
    coded({lengths.begin(), lengths.begin() + literals}, {lengths.begin() + literals, lengths.end()});
  }
  void coded(const std::vector<unsigned>& literal_lengths, const std::vector<unsigned>& distance_lengths) {
    static const unsigned base[29] = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                      31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
    static const unsigned extra[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                       2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
    const Code literal(literal_lengths), distance(distance_lengths);
    while (true) {
      const unsigned s = decode(literal);
      if (s == 256) return;
      if (s < 256) {
        out_ += static_cast<char>(s);
        continue;
      }
      if (s > 285) refuse("a length that is none");
      const unsigned length = base[s - 257] + bits(extra[s - 257]), d = decode(distance);
      if (d > 29) refuse("a distance that is none");
      const unsigned more = d < 4 ? 0 : d / 2 - 1;
      const std::size_t back = (d < 4 ? d + 1 : ((2u + (d & 1)) << more) + 1) + bits(more);
      if (back > out_.size()) refuse("a distance beyond the data's start");
      for (unsigned i = 0; i < length; ++i) out_ += out_[out_.size() - back];
    }
  }
  const std::string& in_;
  std::size_t at_;
  std::uint64_t hold_ = 0;
  unsigned held_ = 0;
  std::string out_;
};

struct Element {
  unsigned type = 0;
  std::string data;
};
std::uint32_t word(const std::string& data, std::size_t at) {
  if (at + 4 > data.size()) refuse("data end early");
  std::uint32_t value = 0;
  std::memcpy(&value, data.data() + at, 4);
  return value;
}
std::vector<Element> elements(const std::string& data, std::size_t at) {
  std::vector<Element> list;
  while (at + 8 <= data.size()) {
    const std::uint32_t tag = word(data, at);
    const bool small = tag >> 16 != 0;
    const std::size_t bytes = small ? tag >> 16 : word(data, at + 4), from = small ? at + 4 : at + 8;
    if (small && bytes > 4) refuse("a small element of " + std::to_string(bytes) + " bytes");
    if (from + bytes > data.size()) refuse("data end early");
    list.push_back({small ? tag & 0xffff : tag, data.substr(from, bytes)});
    at = small ? at + 8 : from + bytes;
    if (!small && list.back().type != 15) at = (at + 7) / 8 * 8;
  }
  return list;
}

template <class T>
void append(const std::string& data, std::vector<double>& numbers) {
  for (std::size_t at = 0; at + sizeof(T) <= data.size(); at += sizeof(T)) {
    T value;
    std::memcpy(&value, data.data() + at, sizeof(T));
    numbers.push_back(static_cast<double>(value));
  }
}
std::vector<double> numbers_of(const Element& e) {
  std::vector<double> n;
  switch (e.type) {
    case 1: append<std::int8_t>(e.data, n); break;
    case 2: append<std::uint8_t>(e.data, n); break;
    case 3: append<std::int16_t>(e.data, n); break;
    case 4: append<std::uint16_t>(e.data, n); break;
    case 5: append<std::int32_t>(e.data, n); break;
    case 6: append<std::uint32_t>(e.data, n); break;
    case 7: append<float>(e.data, n); break;
    case 9: append<double>(e.data, n); break;
    default: refuse("numbers of type " + std::to_string(e.type));
  }
  return n;
}

std::pair<std::string, MatArray> array_of(const std::string& data) {
  const std::vector<Element> parts = elements(data, 0);
  if (parts.size() < 3 || parts[0].type != 6 || parts[1].type != 5) refuse("an array without flags and dimensions");
  const std::uint32_t flags = word(parts[0].data, 0), kind = flags & 0xff;
  if (flags & 0x800) refuse("complex numbers");
  MatArray array;
  std::size_t count = 1;
  for (const double d : numbers_of(parts[1])) {
    array.dimensions.push_back(static_cast<std::size_t>(d));
    count *= array.dimensions.back();
  }
  const auto nested = [&](std::size_t k) {
    if (k >= parts.size() || parts[k].type != 14) refuse("a struct or cell lacks an element");
    return array_of(parts[k].data).second;
  };
  if (kind == 1) {
    for (std::size_t k = 0; k < count; ++k) array.cells.push_back(nested(3 + k));
  } else if (kind == 2) {
    if (parts.size() < 5) refuse("a struct without fields");
    const std::size_t width = word(parts[3].data, 0), fields = width > 0 ? parts[4].data.size() / width : 0;
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t f = 0; f < fields; ++f)
        array.fields[parts[4].data.substr(f * width, width).c_str()].push_back(nested(5 + k * fields + f));
  } else if (kind >= 6 && kind <= 13) {
    if (parts.size() < 4) refuse("an array without numbers");
    array.numbers = numbers_of(parts[3]);
    if (array.numbers.size() != count) refuse("an array with another count than its dimensions");
  } else {
    refuse("an array of class " + std::to_string(kind));
  }
  return {parts[2].data, array};
}

// The first 3 x 3 array called K.
const MatArray* camera_matrix(const MatArray& array) {
  for (const auto& [name, list] : array.fields)
    for (const MatArray& inner : list) {
      if (name == "K" && inner.dimensions == std::vector<std::size_t>{3, 3}) return &inner;
      if (const MatArray* found = camera_matrix(inner)) return found;
    }
  return nullptr;
}

}  // namespace

std::map<std::string, MatArray> read_mat(const std::filesystem::path& path) {
  const std::string data = read_file(path);
  if (data.size() < 128 || !data.starts_with("MATLAB 5.0 MAT-file") || data.substr(126, 2) != "IM")
    refuse(path.string() + " is no little-endian MAT-file of version 5");
  std::map<std::string, MatArray> arrays;
  for (const Element& outer : elements(data, 128)) {
    if (outer.type == 14) {
      arrays.insert(array_of(outer.data));
      continue;
    }
    if (outer.type != 15) refuse("an element of type " + std::to_string(outer.type));
    const std::string inflated = Inflater(outer.data).run();
    for (const Element& inner : elements(inflated, 0)) {
      if (inner.type != 14) refuse("an element of type " + std::to_string(inner.type));
      arrays.insert(array_of(inner.data));
    }
  }
  return arrays;
}

Film read_film(const std::filesystem::path& data, const std::filesystem::path& camera) {
  const auto arrays = read_mat(data), cameras = read_mat(camera);
  const auto &p = arrays.at("p").fields.at("p"), &truth = arrays.at("Pgth").fields.at("P");
  if (p.size() != truth.size()) refuse("p and Pgth have different numbers of frames");
  Film film;
  for (std::size_t f = 0; f < p.size(); ++f) {
    if (p[f].rows() != 3 || truth[f].rows() != 3 || p[f].columns() != truth[f].columns())
      refuse("p and Pgth are not 3 x points alike");
    film.pixels.emplace_back();
    film.places.emplace_back();
    for (std::size_t k = 0; k < p[f].columns(); ++k) {
      film.pixels.back().push_back({p[f].at(0, k) / p[f].at(2, k), p[f].at(1, k) / p[f].at(2, k)});
      film.places.back().push_back({truth[f].at(0, k), truth[f].at(1, k), truth[f].at(2, k)});
    }
  }
  const MatArray* k = nullptr;
  for (const auto& [name, array] : cameras)
    if (k == nullptr) k = camera_matrix(array);
  if (k == nullptr) refuse(camera.string() + " has no camera matrix K");
  film.fx_px = k->at(0, 0), film.fy_px = k->at(1, 1), film.cx_px = k->at(0, 2), film.cy_px = k->at(1, 2);
  return film;
}

std::string film_manifest(const Film& film, double metres) {
  char text[400];
  std::snprintf(text, sizeof text,
                "{\"gonio\":1,\"cameras\":{\"c\":{\"model\":\"orthographic\",\"width_px\":%d,\"height_px\":%d,"
                "\"px_per_m\":1,\"cx_px\":%.9g,\"cy_px\":%.9g}},\"tables\":{\"film\":{\"model\":\"tracks\","
                "\"camera\":\"c\",\"columns\":{\"frame\":\"1\",\"point\":\"1\",\"x_m\":\"m\",\"y_m\":\"m\",\"z_m\":"
                "\"m\",\"u_px\":\"px\",\"v_px\":\"px\"},\"observed\":[\"u_px\",\"v_px\"],\"rows\":[",
                static_cast<int>(2 * film.cx_px), static_cast<int>(2 * film.cy_px), film.cx_px, film.cy_px);
  std::string manifest = text;
  bool first = true;
  for (std::size_t f = 0; f < film.pixels.size(); ++f)
    for (std::size_t k = 0; k < film.pixels[f].size(); ++k) {
      const auto& place = film.places[f][k];
      std::snprintf(text, sizeof text, "%s[%zu,%zu,%.9g,%.9g,%.9g,%.9g,%.9g]", first ? "" : ",", f + 1, k + 1,
                    place[0] * metres, place[1] * metres, place[2] * metres, film.pixels[f][k][0],
                    film.pixels[f][k][1]);
      manifest += text;
      first = false;
    }
  return manifest + "]}}}\n";
}

}  // namespace gonio::tests
