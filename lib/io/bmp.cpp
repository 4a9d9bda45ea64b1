// See bmp.h. Places of the fields below, in bytes (Microsoft, BITMAPFILEHEADER, BITMAPCOREHEADER, BITMAPINFOHEADER and
// later). Rows are filled up to whole 32-bit words. Masks say which bits are red, green and blue; the decoder knows the
// usual ones only and would exchange colours under others without a word, hence the refusal.
#include "io/bmp.h"

#include <array>

#include "base/error.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

enum Place : std::size_t {
  first_pixel = 10,
  info_bytes = 14,
  columns = 18,
  rows = 22,
  core_rows = 20,
  core_bits = 24,
  bits = 28,
  coding = 30,
  colour_masks = 54
};
constexpr std::uint32_t core_info = 12, shortest_info = 40, longest_info = 124;
constexpr std::uint32_t plain = 0, run_length_8 = 1, run_length_4 = 2, by_masks = 3;

[[noreturn]] void refuse_bmp(const std::string& place, const std::string& problem, const char* remedy) {
  throw Error(Exit::data, place, problem, remedy);
}

void need_bmp_bytes(std::string_view bytes, std::size_t wanted, const std::string& place) {
  if (bytes.size() < wanted)
    refuse_bmp(place, "the BMP file is cut off after " + std::to_string(bytes.size()) + " bytes",
               "export or copy it again");
}

void check_bmp_masks(std::string_view bytes, unsigned depth, const std::string& place) {
  need_bmp_bytes(bytes, colour_masks + 12, place);
  const auto mask = [&](std::size_t i) { return stored_at<std::uint32_t>(bytes, colour_masks + 4 * i); };
  const std::array<std::uint32_t, 3> has{mask(0), mask(1), mask(2)};
  const bool known = depth == 32 ? has == std::array<std::uint32_t, 3>{0xff0000, 0xff00, 0xff}
                                 : has == std::array<std::uint32_t, 3>{0x7c00, 0x3e0, 0x1f} ||
                                       has == std::array<std::uint32_t, 3>{0xf800, 0x7e0, 0x1f};
  if (!known)
    refuse_bmp(place, "the BMP file has its colours in unusual bits", "export it as PNG, or as BMP of 24 bits");
}

bool is_bmp_depth(std::uint32_t depth, std::uint32_t code) {
  switch (code) {
    case plain: return depth == 1 || depth == 4 || depth == 8 || depth == 16 || depth == 24 || depth == 32;
    case run_length_8: return depth == 8;
    case run_length_4: return depth == 4;
    case by_masks: return depth == 16 || depth == 32;
    default: return false;
  }
}

}  // namespace

bool is_bmp(std::string_view bytes) {
  if (bytes.size() < info_bytes + 4 || !bytes.starts_with("BM")) return false;
  const auto info = stored_at<std::uint32_t>(bytes, info_bytes);
  return info == core_info || (info >= shortest_info && info <= longest_info);
}

RasterHeader read_bmp_header(std::string_view bytes, const std::string& place) {
  const bool core = stored_at<std::uint32_t>(bytes, info_bytes) == core_info;
  need_bmp_bytes(bytes, info_bytes + (core ? core_info : shortest_info), place);
  const std::int64_t width =
      core ? stored_at<std::uint16_t>(bytes, columns) : std::int64_t{stored_at<std::int32_t>(bytes, columns)};
  const std::int64_t signed_height =
      core ? stored_at<std::uint16_t>(bytes, core_rows) : std::int64_t{stored_at<std::int32_t>(bytes, rows)};
  const std::int64_t height = signed_height < 0 ? -signed_height : signed_height;  // negative: from the top
  const std::uint32_t depth = stored_at<std::uint16_t>(bytes, core ? core_bits : bits),
                      code = core ? plain : stored_at<std::uint32_t>(bytes, coding);
  if (width < 0) refuse_bmp(place, "the BMP file claims a negative width", "export or copy it again");
  if (!is_bmp_depth(depth, code))
    refuse_bmp(place,
               "the BMP file has pixels of " + std::to_string(depth) + " bits, coding " + std::to_string(code) +
                   ", which are not read",
               "export it as PNG, or as BMP of 24 bits");
  if (code == by_masks) check_bmp_masks(bytes, depth, place);
  const std::uint64_t at = stored_at<std::uint32_t>(bytes, first_pixel);
  const auto w = static_cast<std::uint64_t>(width), h = static_cast<std::uint64_t>(height);
  const std::uint64_t row = (w * depth + 31) / 32 * 4;
  // Below 2^31 each, and a row below 2^33 bytes: the product fits. Run lengths are the decoder's to check.
  const std::uint64_t wanted = at + (code == plain || code == by_masks ? row * h : 0);
  if (at < info_bytes + 4 || wanted > bytes.size())
    refuse_bmp(place,
               "the BMP file is cut off: " + std::to_string(w) + " x " + std::to_string(h) + " pixels from byte " +
                   std::to_string(at) + " on, and it has " + std::to_string(bytes.size()) + " bytes",
               "export or copy it again");
  return {w, h, 8, RasterKind::bmp};
}

}  // namespace gonio::io
