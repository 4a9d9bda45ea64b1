// PNG (ISO 15948), JPEG (ITU-T T.81) and TIFF 6.0, as far as is needed to know the size and that the file is whole (BMP
// and TGA: bmp.h, tga.h). The
// libraries that decode them allocate what the header claims and paint what is missing grey; hence this look
// beforehand.
#include "io/raster_header.h"

#include <optional>

#include "base/error.h"
#include "io/bmp.h"
#include "io/png_grey.h"
#include "io/tga.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t harmless_bytes = std::uint64_t{64} << 20;
constexpr std::uint64_t most_bytes = std::uint64_t{16} << 30;
// Deflate reaches 1032 : 1, and a pixel of one bit becomes three floats, 96 times its size.
constexpr std::uint64_t largest_compression = 1032 * 96;

[[noreturn]] void refuse(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "export or copy it again");
}

// Bytes as unsigned numbers, checked against the end of the file.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& place) : bytes_(bytes), place_(place) {}
  std::uint64_t big(std::size_t at, std::size_t count) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value = value << 8 | byte(at + i);
    return value;
  }
  std::uint64_t little(std::size_t at, std::size_t count) const {
    std::uint64_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | byte(at + i);
    return value;
  }
  std::uint8_t byte(std::size_t at) const {
    if (at >= bytes_.size()) refuse(place_, "the file is cut off after " + std::to_string(bytes_.size()) + " bytes");
    return static_cast<std::uint8_t>(bytes_[at]);
  }

 private:
  std::string_view bytes_;
  const std::string& place_;
};

// Chunks: length, type, data, CRC-32 over type and data; the first is IHDR, the last IEND.
RasterHeader png(std::string_view bytes, const std::string& place) {
  const Reader read(bytes, place);
  std::size_t at = 8;
  while (true) {
    const std::uint64_t length = read.big(at, 4);
    if (length > bytes.size() || at + length + 12 > bytes.size()) refuse(place, "the PNG file is cut off");
    const std::string_view body = bytes.substr(at + 4, length + 4);
    if (read.big(at + 8 + length, 4) != crc32_of(body))
      refuse(place, "the PNG file is damaged at byte " + std::to_string(at));
    if (body.starts_with("IEND")) break;
    at += length + 12;
  }
  return {read.big(16, 4), read.big(20, 4), read.byte(24) == 16 ? 16 : 8, RasterKind::png};
}

bool starts_frame(std::uint8_t marker) {  // SOF0 .. SOF15 without DHT, JPG, DAC
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

// Segments up to the first scan; within scans, the byte ff is followed by d9 only at the end of the picture.
RasterHeader jpeg(std::string_view bytes, const std::string& place) {
  const Reader read(bytes, place);
  RasterHeader header;
  std::size_t at = 2;
  while (true) {
    if (read.byte(at) != 0xff) refuse(place, "the JPEG file is damaged at byte " + std::to_string(at));
    const std::uint8_t marker = read.byte(at + 1);
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    if (starts_frame(marker)) header = {read.big(at + 7, 2), read.big(at + 5, 2), 8, RasterKind::jpeg};
    at += 2 + read.big(at + 2, 2);
    if (marker == 0xda) break;
  }
  if (at > bytes.size() || bytes.find("\xff\xd9", at) == std::string_view::npos)
    refuse(place, "the JPEG file is cut off");
  return header;
}

// The first image file directory: width, height and whether the strips or tiles lie inside the file.
class Tiff {
 public:
  Tiff(std::string_view bytes, const std::string& place)
      : read_(bytes, place), size_(bytes.size()), place_(place), little_(bytes[0] == 'I') {}
  RasterHeader header() const {
    const std::size_t directory = number(4, 4);
    const std::size_t entries = number(directory, 2);
    std::optional<std::size_t> offsets, counts;
    RasterHeader result;
    result.kind = RasterKind::tiff;
    for (std::size_t i = 0; i < entries; ++i) {
      const std::size_t entry = directory + 2 + 12 * i;
      const std::size_t tag = number(entry, 2);
      if (tag == 256) result.width = value(entry, 0);
      if (tag == 257) result.height = value(entry, 0);
      if (tag == 258) result.code_bits = value(entry, 0) == 16 ? 16 : 8;
      if (tag == 273 || tag == 324) offsets = entry;
      if (tag == 279 || tag == 325) counts = entry;
    }
    if (!offsets || !counts) refuse(place_, "the TIFF file names no pixels");
    const std::size_t pieces = number(*offsets + 4, 4);
    if (pieces != number(*counts + 4, 4) || pieces > size_) refuse(place_, "the TIFF file's list of strips is damaged");
    for (std::size_t i = 0; i < pieces; ++i)
      if (value(*offsets, i) + value(*counts, i) > size_) refuse(place_, "the TIFF file is cut off");
    return result;
  }

 private:
  std::size_t number(std::size_t at, std::size_t count) const {
    return little_ ? read_.little(at, count) : read_.big(at, count);
  }
  // Element `i` of a directory entry of type SHORT or LONG; up to four bytes lie in the entry itself.
  std::size_t value(std::size_t entry, std::size_t i) const {
    const std::size_t width = number(entry + 2, 2) == 3 ? 2 : 4;
    const std::size_t first = number(entry + 4, 4) * width <= 4 ? entry + 8 : number(entry + 8, 4);
    return number(first + i * width, width);
  }
  Reader read_;
  std::size_t size_;
  const std::string& place_;
  bool little_;
};

}  // namespace

RasterHeader read_raster_header(std::string_view bytes, const std::string& place) {
  using namespace std::string_view_literals;
  if (bytes.empty()) refuse(place, "the file is empty");
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return png(bytes, place);
  if (bytes.starts_with("\xff\xd8"sv)) return jpeg(bytes, place);
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return Tiff(bytes, place).header();
  if (is_bmp(bytes)) return read_bmp_header(bytes, place);
  if (is_tga(bytes)) return read_tga_header(bytes, place);
  refuse(place, "is neither PNG, JPEG, TIFF, BMP nor TGA inside");
}

void check_decoded_size(std::uint64_t width, std::uint64_t height, std::uint64_t pixel_bytes, std::uint64_t file_bytes,
                        const std::string& place) {
  if (width == 0 || height == 0) refuse(place, "the picture is empty");
  const std::uint64_t most_pixels = most_bytes / pixel_bytes;
  const bool too_large = width > most_pixels || height > most_pixels / width;
  const std::uint64_t decoded = too_large ? most_bytes : width * height * pixel_bytes;
  if (too_large || (decoded > harmless_bytes && decoded / largest_compression > file_bytes))
    refuse(place, "the header claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels, which " +
                      std::to_string(file_bytes) + " bytes cannot hold");
}

}  // namespace gonio::io
