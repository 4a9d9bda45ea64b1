// ISO 15948, sections 9 (filters) and 10 (deflate). Rows lose their filters where they were unpacked, one byte further
// to the front with each.
#include "io/png_grey.h"

#include <libdeflate.h>

#include <cstring>
#include <memory>
#include <string>

namespace gonio::io {
namespace {

enum Filter : std::uint8_t { none, sub, up, average, paeth };

std::uint32_t big(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

// What the left, the upper and the upper left byte predict.
int predicted_by_paeth(int left, int above, int beyond) {
  const int to_left = std::abs(above - beyond), to_above = std::abs(left - beyond),
            to_beyond = std::abs(left + above - 2 * beyond);
  const int nearest = to_above <= to_beyond ? above : beyond;
  return to_left <= to_above && to_left <= to_beyond ? left : nearest;
}

// `from` may lie behind `to` in the same buffer; `above`: the row before, without its filter.
bool unfilter(std::uint8_t filter, const std::uint8_t* from, const std::uint8_t* above, std::size_t width,
              std::uint8_t* to) {
  unsigned left = 0;
  switch (filter) {
    case none: std::memmove(to, from, width); return true;
    case sub:
      for (std::size_t x = 0; x < width; ++x) to[x] = static_cast<std::uint8_t>(left = (from[x] + left) & 255u);
      return true;
    case up:
      for (std::size_t x = 0; x < width; ++x) to[x] = static_cast<std::uint8_t>(from[x] + above[x]);
      return true;
    case average:
      for (std::size_t x = 0; x < width; ++x)
        to[x] = static_cast<std::uint8_t>(left = (from[x] + ((left + above[x]) >> 1)) & 255u);
      return true;
    case paeth:
      for (std::size_t x = 0; x < width; ++x) {
        const int beyond = x > 0 ? above[x - 1] : 0;
        left = static_cast<unsigned>(from[x] + predicted_by_paeth(static_cast<int>(left), above[x], beyond)) & 255u;
        to[x] = static_cast<std::uint8_t>(left);
      }
      return true;
    default: return false;
  }
}

// The picture's chunks joined; a single one where it lies.
std::string_view packed_pixels(std::string_view bytes, std::string& joined) {
  std::string_view first;
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t length = big(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (type == "IEND") break;
    if (type == "IDAT") {
      const std::string_view own = bytes.substr(at + 8, length);
      if (!first.empty() && joined.empty()) joined = first;
      if (first.empty())
        first = own;
      else
        joined += own;
    }
    at += length + 12;
  }
  return joined.empty() ? first : std::string_view(joined);
}

}  // namespace

std::optional<std::vector<std::uint8_t>> decode_png_of_grey_bytes(std::string_view bytes, const RasterHeader& header) {
  // Bits, colour type, compression, filters, interlacing.
  if (header.kind != RasterKind::png || bytes.substr(24, 5) != std::string_view("\x08\0\0\0\0", 5)) return std::nullopt;
  std::string joined;
  const std::string_view packed = packed_pixels(bytes, joined);
  const auto width = static_cast<std::size_t>(header.width), height = static_cast<std::size_t>(header.height);
  std::vector<std::uint8_t> rows((width + 1) * height);
  thread_local const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflate(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!inflate || libdeflate_zlib_decompress(inflate.get(), packed.data(), packed.size(), rows.data(), rows.size(),
                                             nullptr) != LIBDEFLATE_SUCCESS)
    return std::nullopt;
  const std::vector<std::uint8_t> nothing(width);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* const from = rows.data() + y * (width + 1);
    std::uint8_t* const to = rows.data() + y * width;
    if (!unfilter(from[0], from + 1, y > 0 ? to - width : nothing.data(), width, to)) return std::nullopt;
  }
  rows.resize(width * height);
  return rows;
}

namespace {

std::string big_endian(std::size_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

void append_chunk(std::string& file, std::string_view type, std::string_view data) {
  file += big_endian(data.size());
  const std::size_t from = file.size();
  file.append(type).append(data);
  file += big_endian(crc32_of(std::string_view(file).substr(from)));
}

// Bytes as signed differences: how large they are in sum.
std::size_t size_of_differences(const std::uint8_t* row, std::size_t width) {
  std::size_t sum = 0;
  for (std::size_t x = 0; x < width; ++x) sum += row[x] < 128 ? row[x] : 256u - row[x];
  return sum;
}

// One row behind its filter's number; `trial` is room for another.
void filter_row(const std::uint8_t* row, const std::uint8_t* above, std::size_t width, std::uint8_t* to,
                std::uint8_t* trial) {
  to[0] = up;
  for (std::size_t x = 0; x < width; ++x) to[x + 1] = static_cast<std::uint8_t>(row[x] - above[x]);
  std::size_t least = size_of_differences(to + 1, width);
  if (least == 0) return;
  trial[0] = sub;
  trial[1] = row[0];
  for (std::size_t x = 1; x < width; ++x) trial[x + 1] = static_cast<std::uint8_t>(row[x] - row[x - 1]);
  if (const std::size_t size = size_of_differences(trial + 1, width); size < least) {
    least = size;
    std::memcpy(to, trial, width + 1);
  }
  if (size_of_differences(row, width) < least) {
    to[0] = none;
    std::memcpy(to + 1, row, width);
  }
}

}  // namespace

std::string encode_png_of_grey_bytes(std::span<const std::uint8_t> rows, std::size_t width) {
  const std::size_t height = width == 0 ? 0 : rows.size() / width;
  std::vector<std::uint8_t> filtered((width + 1) * height), trial(width + 1), nothing(width);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* const row = rows.data() + y * width;
    filter_row(row, y > 0 ? row - width : nothing.data(), width, filtered.data() + y * (width + 1), trial.data());
  }
  thread_local const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> deflate(
      libdeflate_alloc_compressor(6), &libdeflate_free_compressor);
  if (!deflate) throw std::bad_alloc();
  std::string packed(libdeflate_zlib_compress_bound(deflate.get(), filtered.size()), '\0');
  packed.resize(
      libdeflate_zlib_compress(deflate.get(), filtered.data(), filtered.size(), packed.data(), packed.size()));
  std::string file("\x89PNG\r\n\x1a\n", 8);
  append_chunk(file, "IHDR", big_endian(width) + big_endian(height) + std::string("\x08\0\0\0\0", 5));
  append_chunk(file, "IDAT", packed);
  append_chunk(file, "IEND", {});
  return file;
}

std::uint32_t crc32_of(std::string_view bytes) {
  return libdeflate_crc32(0, bytes.data(), bytes.size());
}

}  // namespace gonio::io
