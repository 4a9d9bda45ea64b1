// A DNG of the barest kind (Adobe, Digital Negative specification 1.4; TIFF 6.0), laid out by hand: little-endian, one
// strip of 16-bit samples, a masked border at the left and at the top.
#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gonio::tests {

struct Dng {
  int width = 64, height = 48;         // of all pixels
  int left = 0, top = 0;               // that see no light
  std::string filters{"\0\1\1\2", 4};  // red, green, blue are 0, 1, 2
  std::uint32_t white = 4095;
  std::uint32_t exposure_us = 4000, iso = 200;
  std::vector<std::uint16_t> samples;  // of all pixels, row by row
};

namespace detail {

inline void put(std::string& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * i & 0xFF);
}

struct TiffField {
  int type;  // 1 byte, 2 text, 3 short, 4 long, 5 fraction
  std::uint32_t count;
  std::string bytes;
};
inline TiffField longs(const std::vector<std::uint32_t>& values, int type = 4) {
  TiffField field{type, static_cast<std::uint32_t>(values.size() / (type == 5 ? 2 : 1)), {}};
  for (const std::uint32_t value : values) put(field.bytes, value, type == 3 ? 2 : type == 1 ? 1 : 4);
  return field;
}
inline TiffField text(const std::string& words) {
  return {2, static_cast<std::uint32_t>(words.size() + 1), words + '\0'};
}

// A directory that begins at `at`, and behind it what does not fit into its entries.
inline std::string directory(const std::map<int, TiffField>& fields, std::size_t at) {
  std::string head, rest;
  const std::size_t behind = at + 2 + 12 * fields.size() + 4;
  put(head, static_cast<std::uint32_t>(fields.size()), 2);
  for (const auto& [tag, field] : fields) {
    put(head, static_cast<std::uint32_t>(tag), 2);
    put(head, static_cast<std::uint32_t>(field.type), 2);
    put(head, field.count, 4);
    std::string value = field.bytes;
    if (value.size() > 4) {
      put(head, static_cast<std::uint32_t>(behind + rest.size()), 4);
      rest += value;
      rest.resize(rest.size() + rest.size() % 2);
    } else {
      value.resize(4);
      head += value;
    }
  }
  put(head, 0, 4);
  return head + rest;
}

}  // namespace detail

inline std::string bytes_of(const Dng& dng) {
  using detail::longs, detail::text;
  const auto width = static_cast<std::uint32_t>(dng.width), height = static_cast<std::uint32_t>(dng.height);
  std::string pixels;
  for (const std::uint16_t sample : dng.samples) detail::put(pixels, sample, 2);
  const std::size_t first = 8 + pixels.size() + pixels.size() % 2;
  std::map<int, detail::TiffField> fields{
      {254, longs({0})},
      {256, longs({width})},
      {257, longs({height})},
      {258, longs({16}, 3)},
      {259, longs({1}, 3)},
      {262, longs({32803}, 3)},
      {271, text("Gonio")},
      {272, text("Written By Hand")},
      {273, longs({8})},
      {277, longs({1}, 3)},
      {278, longs({height})},
      {279, longs({static_cast<std::uint32_t>(pixels.size())})},
      {33421, longs({2, 2}, 3)},
      {33422, {1, 4, dng.filters}},
      {34665, longs({0})},
      {50706, longs({1, 4, 0, 0}, 1)},
      {50708, text("Gonio Written By Hand")},
      {50717, longs({dng.white})},
      {50829, longs({static_cast<std::uint32_t>(dng.top), static_cast<std::uint32_t>(dng.left), height, width})}};
  const std::size_t exif = first + detail::directory(fields, first).size();
  fields[34665] = longs({static_cast<std::uint32_t>(exif)});
  std::string bytes = "II*";
  bytes += '\0';
  detail::put(bytes, static_cast<std::uint32_t>(first), 4);
  bytes += pixels;
  bytes.resize(first);
  bytes += detail::directory(fields, first);
  bytes += detail::directory({{33434, longs({dng.exposure_us, 1000000}, 5)}, {34855, longs({dng.iso}, 3)}}, exif);
  return bytes;
}

}  // namespace gonio::tests
