// See tga.h. Places of the head's fields below, in bytes; behind its 18 bytes follow a text, the colour map and the
// pixels, blue first. A packet of a run-length coded file is a byte, whose lowest seven bits count the pixels less one,
// and either one pixel to repeat (highest bit 1) or as many pixels as it says; packets may run on into the next row.
#include "io/tga.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::size_t head = 18;
enum Place : std::size_t {
  text_bytes = 0,
  has_map = 1,
  kind = 2,
  map_first = 3,
  map_entries = 5,
  map_bits = 7,
  columns = 12,
  rows = 14,
  pixel_bits = 16,
  descriptor = 17
};
constexpr unsigned char mapped = 1, colour = 2, grey = 3, run_length = 8, from_right = 0x10, from_top = 0x20;
constexpr std::uint64_t most_in_packet = 128;

[[noreturn]] void refuse_tga(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "export or copy it again");
}

struct TgaHead {
  std::uint64_t width = 0, height = 0;
  std::size_t bytes_per_pixel = 0, map_offset = 0, map_count = 0, map_start = 0, map_bytes = 0, pixels = 0;
  unsigned char type = 0;  // without run_length
  bool packed = false, mirrored = false, top_first = false;
};

unsigned char byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}

std::size_t bytes_of_bits(unsigned char bits) {
  return (std::size_t{bits} + 7) / 8;
}

bool is_depth(unsigned char type, unsigned char bits) {
  if (type == colour) return bits == 15 || bits == 16 || bits == 24 || bits == 32;
  return bits == 8 || bits == 16;
}

TgaHead head_of(std::string_view bytes, const std::string& place) {
  TgaHead h;
  h.type = byte_at(bytes, kind) & static_cast<unsigned char>(~run_length);
  h.packed = (byte_at(bytes, kind) & run_length) != 0;
  h.width = stored_at<std::uint16_t>(bytes, columns), h.height = stored_at<std::uint16_t>(bytes, rows);
  h.bytes_per_pixel = bytes_of_bits(byte_at(bytes, pixel_bits));
  h.mirrored = (byte_at(bytes, descriptor) & from_right) != 0;
  h.top_first = (byte_at(bytes, descriptor) & from_top) != 0;
  h.map_offset = head + byte_at(bytes, text_bytes);
  if (byte_at(bytes, has_map) != 0) {
    h.map_start = stored_at<std::uint16_t>(bytes, map_first),
    h.map_count = stored_at<std::uint16_t>(bytes, map_entries);
    h.map_bytes = bytes_of_bits(byte_at(bytes, map_bits));
  }
  h.pixels = h.map_offset + h.map_count * h.map_bytes;
  if (h.type == mapped && h.map_count == 0) refuse_tga(place, "the TGA file names colours and has no map of them");
  if (h.pixels > bytes.size()) refuse_tga(place, "the TGA file is cut off");
  const std::uint64_t count = h.width * h.height, left = bytes.size() - h.pixels;
  const std::uint64_t least =
      h.packed ? (count + most_in_packet - 1) / most_in_packet * (1 + h.bytes_per_pixel) : count * h.bytes_per_pixel;
  if (left < least)
    refuse_tga(place, "the TGA file is cut off: " + std::to_string(h.width) + " x " + std::to_string(h.height) +
                          " pixels take at least " + std::to_string(least) + " bytes, and " + std::to_string(left) +
                          " are there");
  return h;
}

using Bgr = std::array<std::uint8_t, 3>;

// One pixel, or one entry of the map.
Bgr colour_at(std::string_view bytes, std::size_t at, std::size_t size) {
  if (size >= 3) return {byte_at(bytes, at), byte_at(bytes, at + 1), byte_at(bytes, at + 2)};
  if (size == 1) return {byte_at(bytes, at), byte_at(bytes, at), byte_at(bytes, at)};
  const auto five = stored_at<std::uint16_t>(bytes, at);
  const auto widened = [&](int shift) { return static_cast<std::uint8_t>(((five >> shift & 31) * 255 + 15) / 31); };
  return {widened(0), widened(5), widened(10)};
}

class Unpacker {
 public:
  Unpacker(std::string_view bytes, const TgaHead& h, const std::string& place)
      : bytes_(bytes), place_(place), size_(h.bytes_per_pixel), at_(h.pixels), packed_(h.packed) {}
  // Where the next pixel's bytes stand.
  std::size_t next() {
    if (!packed_) return advance(size_);
    if (left_ == 0) {
      const unsigned char packet = byte_at(bytes_, advance(1));
      left_ = (packet & 127u) + 1, repeats_ = (packet & 128u) != 0;
      if (repeats_) repeated_ = advance(size_);
    }
    --left_;
    return repeats_ ? repeated_ : advance(size_);
  }

 private:
  std::size_t advance(std::size_t by) {
    if (bytes_.size() - at_ < by)
      refuse_tga(place_, "the TGA file is cut off after " + std::to_string(bytes_.size()) + " bytes");
    at_ += by;
    return at_ - by;
  }
  std::string_view bytes_;
  const std::string& place_;
  std::size_t size_, at_, repeated_ = 0;
  unsigned left_ = 0;
  bool packed_, repeats_ = false;
};

}  // namespace

bool is_tga(std::string_view bytes) {
  if (bytes.size() < head) return false;
  const unsigned char type = byte_at(bytes, kind) & static_cast<unsigned char>(~run_length),
                      map = byte_at(bytes, has_map), bits = byte_at(bytes, map_bits);
  const bool map_known = map == 0 || (map == 1 && (bits == 15 || bits == 16 || bits == 24 || bits == 32));
  return map_known && (type == mapped || type == colour || type == grey) && (type != mapped || map == 1) &&
         is_depth(type, byte_at(bytes, pixel_bits)) && byte_at(bytes, descriptor) < 0x40;
}

RasterHeader read_tga_header(std::string_view bytes, const std::string& place) {
  const TgaHead h = head_of(bytes, place);
  return {h.width, h.height, 8, RasterKind::tga};
}

TgaCodes decode_tga(std::string_view bytes, const std::string& place) {
  const TgaHead h = head_of(bytes, place);
  TgaCodes out{static_cast<int>(h.width), static_cast<int>(h.height), h.type == grey ? 1 : 3, {}};
  const auto channels = static_cast<std::size_t>(out.channels);
  out.codes.resize(h.width * h.height * channels);
  Unpacker unpacker(bytes, h, place);
  for (std::size_t row = 0; row < h.height; ++row)
    for (std::size_t column = 0; column < h.width; ++column) {
      const std::size_t at = unpacker.next();
      const std::size_t y = h.top_first ? row : h.height - 1 - row, x = h.mirrored ? h.width - 1 - column : column;
      std::uint8_t* pixel = &out.codes[(y * h.width + x) * channels];
      if (h.type == grey) {
        *pixel = byte_at(bytes, at);  // of 16 bits the second byte is alpha
        continue;
      }
      std::size_t from = at, size = h.bytes_per_pixel;
      if (h.type == mapped) {
        const std::size_t index = size == 1 ? byte_at(bytes, at) : stored_at<std::uint16_t>(bytes, at);
        if (index < h.map_start || index - h.map_start >= h.map_count)
          refuse_tga(place, "the TGA file names colour " + std::to_string(index) + ", its map has " +
                                std::to_string(h.map_count) + " from " + std::to_string(h.map_start));
        from = h.map_offset + (index - h.map_start) * h.map_bytes, size = h.map_bytes;
      }
      std::ranges::copy(colour_at(bytes, from, size), pixel);
    }
  return out;
}

}  // namespace gonio::io
