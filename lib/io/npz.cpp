// An .npy array: "\x93NUMPY", version, length of the head, the head (io/npy_head.h), data. An .npz is a zip archive of
// them.
#include "io/npz.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "io/little_endian.h"
#include "io/npy_head.h"
#include "io/zip_file.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_entry_bytes = std::uint64_t{1} << 31;

template <class T>
double element(std::string_view bytes, std::size_t i, bool swapped) {
  if (!swapped) return static_cast<double>(stored_at<T>(bytes, i * sizeof(T)));
  std::string turned(bytes.substr(i * sizeof(T), sizeof(T)));
  return static_cast<double>(stored_at<T>(std::string(turned.rbegin(), turned.rend()), 0));
}

// IEEE 754 binary16.
double half(std::string_view bytes, std::size_t i, bool swapped) {
  auto h = stored_at<std::uint16_t>(bytes, 2 * i);
  if (swapped) h = static_cast<std::uint16_t>((h >> 8) | (h << 8));
  const int exponent = (h >> 10) & 31, fraction = h & 1023;
  const double sign = (h & 0x8000) != 0 ? -1 : 1;
  if (exponent == 31) return fraction != 0 ? std::nan("") : sign * HUGE_VAL;
  return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

using Reader = double (*)(std::string_view, std::size_t, bool);
Reader reader_of(const NpyHead& head, const std::string& place) {
  const std::string type = std::string(1, head.kind) + std::to_string(head.bytes);
  static const std::map<std::string, Reader> readers = {{"f2", half},
                                                        {"f4", element<float>},
                                                        {"f8", element<double>},
                                                        {"i1", element<std::int8_t>},
                                                        {"i2", element<std::int16_t>},
                                                        {"i4", element<std::int32_t>},
                                                        {"i8", element<std::int64_t>},
                                                        {"u1", element<std::uint8_t>},
                                                        {"b1", element<std::uint8_t>},
                                                        {"u2", element<std::uint16_t>},
                                                        {"u4", element<std::uint32_t>},
                                                        {"u8", element<std::uint64_t>}};
  const auto found = readers.find(type);
  if (found == readers.end()) refuse_npy(place, "has numbers of type " + type, "save it as float64");
  return found->second;
}

std::string text_of(std::string_view bytes, const NpyHead& head) {
  std::string text;
  const std::size_t width = head.kind == 'U' ? 4 : 1;
  for (std::size_t i = 0; i + width <= bytes.size(); i += width) {
    const unsigned char c = static_cast<unsigned char>(bytes[i + (head.swapped ? width - 1 : 0)]);
    if (c != 0) text += c < 128 ? static_cast<char>(c) : '?';
  }
  return text;
}

// Index in C order of the i-th element in Fortran's order.
std::size_t c_index(std::size_t i, const std::vector<std::size_t>& size) {
  std::size_t index = 0, stride = 1;
  std::vector<std::size_t> at(size.size());
  for (std::size_t k = 0; k < size.size(); ++k) at[k] = i % size[k], i /= size[k];
  for (std::size_t k = size.size(); k-- > 0;) index += at[k] * stride, stride *= size[k];
  return index;
}

}  // namespace

bool parse_npy(std::string_view bytes, const std::string& place, NpyArray& out) {
  const NpyHead head = npy_head(bytes, place, most_entry_bytes);
  if (head.kind == 'O') return false;
  if (const std::size_t wanted = head.count * head.bytes * (head.kind == 'U' ? 4 : 1); bytes.size() != wanted)
    refuse_npy(place, "has " + std::to_string(bytes.size()) + " bytes of data where its head makes " +
                          std::to_string(wanted) + ": truncated");
  out.size = head.size;
  if (head.kind == 'U' || head.kind == 'S') {
    if (head.count == 1) out.text = text_of(bytes, head);
    return head.count == 1;
  }
  const Reader read = reader_of(head, place);
  out.values.resize(head.count);
  for (std::size_t i = 0; i < head.count; ++i)
    out.values[head.fortran ? c_index(i, head.size) : i] = read(bytes, i, head.swapped);
  return true;
}

std::map<std::string, NpyArray> read_npz(const std::filesystem::path& path) {
  const ZipReader archive(path, "NumPy archive");
  std::map<std::string, NpyArray> out;
  for (std::size_t i = 0; i < archive.entries().size(); ++i) {
    std::string name = archive.entries()[i].name;
    if (!name.ends_with(".npy")) continue;
    name.resize(name.size() - 4);
    NpyArray array;
    if (parse_npy(archive.read(i, most_entry_bytes), path.string() + "#" + name, array)) out[name] = std::move(array);
  }
  if (out.empty()) refuse_npy(path.string(), "holds no array of numbers");
  return out;
}

}  // namespace gonio::io
