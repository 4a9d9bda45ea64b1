// An .npy array: "\x93NUMPY", version, length of the head, the head (io/npy_head.h), data. An .npz is a zip archive of
// them.
#include "io/npz.h"

#include <zip.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/little_endian.h"
#include "io/npy_head.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_squeezed = 1032, most_entry_bytes = std::uint64_t{1} << 31;

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

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, Discard>;

Archive opened(const std::string& file, const std::string& place) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(file.data(), file.size(), 0, &error);
  zip_t* archive = source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error);
  const std::string why = archive == nullptr ? zip_error_strerror(&error) : "";
  zip_error_fini(&error);
  if (archive == nullptr) {
    zip_source_free(source);
    refuse_npy(place, "is no whole NumPy archive (" + why + ")");
  }
  return Archive(archive);
}

std::string content(zip_t* archive, zip_uint64_t index, std::uint64_t file_bytes, const std::string& place) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat_index(archive, index, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0)
    refuse_npy(place, "has no length");
  if (stat.size > most_squeezed * file_bytes || stat.size > most_entry_bytes)
    refuse_npy(place, "claims " + std::to_string(stat.size) + " bytes, more than its file can hold");
  std::string bytes(stat.size, '\0');
  zip_file_t* entry = zip_fopen_index(archive, index, 0);
  const zip_int64_t read = entry == nullptr ? -1 : zip_fread(entry, bytes.data(), bytes.size());
  char beyond;  // the checksum is compared where the entry ends
  const bool ends = read == static_cast<zip_int64_t>(bytes.size()) && zip_fread(entry, &beyond, 1) == 0;
  if (entry == nullptr || zip_fclose(entry) != 0 || !ends) refuse_npy(place, "is damaged: its checksum or length is wrong");
  return bytes;
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
  const std::string file = read_file(path), place = path.string();
  const Archive archive = opened(file, place);
  std::map<std::string, NpyArray> out;
  const zip_int64_t entries = zip_get_num_entries(archive.get(), 0);
  for (zip_int64_t i = 0; i < entries; ++i) {
    const char* entry = zip_get_name(archive.get(), static_cast<zip_uint64_t>(i), 0);
    std::string name = entry == nullptr ? "" : entry;
    if (!name.ends_with(".npy")) continue;
    name.resize(name.size() - 4);
    NpyArray array;
    if (parse_npy(content(archive.get(), static_cast<zip_uint64_t>(i), file.size(), place + "#" + name),
                  place + "#" + name, array))
      out[name] = std::move(array);
  }
  if (out.empty()) refuse_npy(place, "holds no array of numbers");
  return out;
}

}  // namespace gonio::io
