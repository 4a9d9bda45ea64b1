// An .npy array: "\x93NUMPY", version, length of the head, the head (a Python literal: descr, fortran_order, shape),
// data. NEP 1 of NumPy has it. An .npz is a zip archive of them.
#include "io/npz.h"

#include <zip.h>

#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <memory>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_squeezed = 1032, most_entry_bytes = std::uint64_t{1} << 31;
constexpr std::size_t longest_head = 1 << 16, most_dimensions = 8;

[[noreturn]] void refuse(const std::string& place, const std::string& problem,
                         const std::string& hint = "write it anew with numpy.savez") {
  throw Error(Exit::data, place, problem, hint);
}

struct Head {
  char kind = 0;          // of numbers: f, i, u, b; of text U, S; of objects O
  std::size_t bytes = 0;  // of an element
  bool swapped = false, fortran = false;
  std::vector<std::size_t> size;
  std::size_t count = 1;
};

// What stands behind 'key': in the head, without blanks before it.
std::string_view after(std::string_view head, std::string_view key, const std::string& place) {
  const std::string quoted = "'" + std::string(key) + "':";
  const auto at = head.find(quoted);
  if (at == std::string_view::npos) refuse(place, "has no " + std::string(key) + " in its head");
  head.remove_prefix(at + quoted.size());
  while (!head.empty() && head.front() == ' ') head.remove_prefix(1);
  return head;
}

std::size_t number_at(std::string_view& text, const std::string& place) {
  std::size_t n = 0, digits = 0;
  for (; !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) != 0; ++digits) {
    n = 10 * n + static_cast<std::size_t>(text.front() - '0');
    if (digits > 17) refuse(place, "has a size of more than 18 digits");
    text.remove_prefix(1);
  }
  if (digits == 0) refuse(place, "has a head that cannot be read");
  return n;
}

void read_shape(std::string_view text, Head& head, const std::string& place) {
  if (text.empty() || text.front() != '(') refuse(place, "has no size in its head");
  text.remove_prefix(1);
  while (!text.empty() && text.front() != ')') {
    if (text.front() == ',' || text.front() == ' ') {
      text.remove_prefix(1);
      continue;
    }
    const std::size_t n = number_at(text, place);
    if (!text.empty() && text.front() == 'L') text.remove_prefix(1);  // of Python 2
    if (head.size.size() == most_dimensions) refuse(place, "has more than 8 dimensions");
    if (n != 0 && head.count > most_entry_bytes / n) refuse(place, "claims more numbers than a file can hold");
    head.size.push_back(n);
    head.count *= n;
  }
}

void read_type(std::string_view text, Head& head, const std::string& place) {
  if (text.empty() || (text.front() != '\'' && text.front() != '"'))
    refuse(place, "is a record of several fields", "write one array for each field");
  text.remove_prefix(1);
  char order = '|';
  if (!text.empty() && std::string_view("<>|=").find(text.front()) != std::string_view::npos)
    order = text.front(), text.remove_prefix(1);
  head.swapped = order == '>';
  if (text.empty()) refuse(place, "has no type in its head");
  head.kind = text.front();
  text.remove_prefix(1);
  if (head.kind == 'O') return;
  if (head.kind == '?') {
    head.kind = 'b', head.bytes = 1;
    return;
  }
  head.bytes = number_at(text, place);
}

Head head_of(std::string_view& bytes, const std::string& place) {
  if (bytes.size() < 10 || !bytes.starts_with("\x93NUMPY")) refuse(place, "is no NumPy array");
  const bool wide = bytes[6] >= 2;
  const std::size_t start = wide ? 12 : 10;
  if (bytes.size() < start) refuse(place, "ends within its head");
  const std::size_t length = wide ? stored_at<std::uint32_t>(bytes, 8) : stored_at<std::uint16_t>(bytes, 8);
  if (length > longest_head || bytes.size() - start < length) refuse(place, "ends within its head");
  const std::string_view text = bytes.substr(start, length);
  bytes.remove_prefix(start + length);
  Head head;
  read_type(after(text, "descr", place), head, place);
  head.fortran = after(text, "fortran_order", place).starts_with("True");
  read_shape(after(text, "shape", place), head, place);
  return head;
}

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
Reader reader_of(const Head& head, const std::string& place) {
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
  if (found == readers.end()) refuse(place, "has numbers of type " + type, "save it as float64");
  return found->second;
}

std::string text_of(std::string_view bytes, const Head& head) {
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
    refuse(place, "is no whole NumPy archive (" + why + ")");
  }
  return Archive(archive);
}

std::string content(zip_t* archive, zip_uint64_t index, std::uint64_t file_bytes, const std::string& place) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat_index(archive, index, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0)
    refuse(place, "has no length");
  if (stat.size > most_squeezed * file_bytes || stat.size > most_entry_bytes)
    refuse(place, "claims " + std::to_string(stat.size) + " bytes, more than its file can hold");
  std::string bytes(stat.size, '\0');
  zip_file_t* entry = zip_fopen_index(archive, index, 0);
  const zip_int64_t read = entry == nullptr ? -1 : zip_fread(entry, bytes.data(), bytes.size());
  char beyond;  // the checksum is compared where the entry ends
  const bool ends = read == static_cast<zip_int64_t>(bytes.size()) && zip_fread(entry, &beyond, 1) == 0;
  if (entry == nullptr || zip_fclose(entry) != 0 || !ends) refuse(place, "is damaged: its checksum or length is wrong");
  return bytes;
}

}  // namespace

bool parse_npy(std::string_view bytes, const std::string& place, NpyArray& out) {
  const Head head = head_of(bytes, place);
  if (head.kind == 'O') return false;
  if (const std::size_t wanted = head.count * head.bytes * (head.kind == 'U' ? 4 : 1); bytes.size() != wanted)
    refuse(place, "has " + std::to_string(bytes.size()) + " bytes of data where its head makes " +
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
  if (out.empty()) refuse(place, "holds no array of numbers");
  return out;
}

}  // namespace gonio::io
