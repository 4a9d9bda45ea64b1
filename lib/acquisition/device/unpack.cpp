#include "acquisition/device/unpack.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

using Packing = PixelFormat::Packing;

// "Bayer.." stands for its four orders. Polarized: FLIR's; Polarize: Lucid's; in both a Bayer filter over the grid of
// polarizers is named as well.
constexpr std::array<std::string_view, 6> mosaic_names{"Mono",         "Bayer..",          "Polarized",
                                                       "PolarizeMono", "Bayer..Polarized", "PolarizeBayer.."};
constexpr std::array<std::string_view, 4> bayer_orders{"RG", "GR", "GB", "BG"};

bool is_mosaic_name(std::string_view name) {
  for (const std::string_view pattern : mosaic_names) {
    if (name.size() != pattern.size()) continue;
    const auto dots = pattern.find("..");
    if (dots == std::string_view::npos) {
      if (name == pattern) return true;
      continue;
    }
    const std::string_view order = name.substr(dots, 2);
    if (std::find(bayer_orders.begin(), bayer_orders.end(), order) != bayer_orders.end() &&
        name.substr(0, dots) == pattern.substr(0, dots) && name.substr(dots + 2) == pattern.substr(dots + 2))
      return true;
  }
  return false;
}

// `count` bits of a stream whose bytes are filled from their lowest bit on.
unsigned bits_at(const std::uint8_t* bytes, std::size_t first, unsigned count) {
  unsigned window = 0;
  for (std::size_t byte = (first + count - 1) / 8 + 1; byte-- > first / 8;) window = (window << 8U) | bytes[byte];
  return (window >> (first % 8)) & ((1U << count) - 1);
}

std::size_t mipi_group(int bits) {
  return bits == 12 ? 2 : 4;
}

// Sample i of `row`, where it is within.
unsigned packed_sample(const std::uint8_t* row, std::size_t i, const PixelFormat& format) {
  const auto bits = static_cast<unsigned>(format.bits);
  if (format.packing == Packing::gige) {
    const std::uint8_t* three = row + i / 2 * 3;
    const unsigned rest = bits - 8, low = three[1] >> (i % 2 == 0 ? 0U : 4U);
    return (static_cast<unsigned>(three[i % 2 == 0 ? 0 : 2]) << rest) | (low & ((1U << rest) - 1));
  }
  if (format.packing == Packing::mipi) {
    const std::size_t group = mipi_group(format.bits);
    const std::uint8_t* begin = row + i / group * (group * bits / 8);
    return static_cast<unsigned>(begin[i % group]) << (bits - 8) |
           bits_at(begin + group, i % group * (bits - 8), bits - 8);
  }
  return bits_at(row, i * bits, bits);
}

std::size_t bytes_of(std::size_t samples, const PixelFormat& format) {
  // The second of a pair lies in the third byte; a first alone needs two.
  if (format.packing == Packing::gige) return samples / 2 * 3 + samples % 2 * 2;
  if (format.packing == Packing::mipi) {
    const std::size_t group = mipi_group(format.bits);
    return (samples + group - 1) / group * (group * static_cast<std::size_t>(format.bits) / 8);
  }
  return (samples * static_cast<std::size_t>(format.bits_per_pixel()) + 7) / 8;
}

}  // namespace

int PixelFormat::bits_per_pixel() const {
  if (packing == Packing::pfnc || packing == Packing::mipi) return bits;
  if (packing == Packing::gige) return 12;
  return bits == 8 ? 8 : 16;
}

// The rows below have what the rows above lack, green beside green being in no grid.
std::string bayer_corner(const std::string& mosaic) {
  if (!mosaic.starts_with("Bayer") || mosaic.size() != 7) return "";
  const char first = mosaic[5], second = mosaic[6];
  const char lacking = first == 'R' || second == 'R' ? 'B' : 'R';
  return {first, second, first == 'G' ? lacking : 'G', first == 'G' ? 'G' : lacking};
}

std::optional<PixelFormat> parse_pixel_format(std::string_view name) {
  const auto digits = std::min(name.find_first_of("0123456789"), name.size());
  PixelFormat format;
  format.mosaic = name.substr(0, digits);
  const auto [end, wrong] = std::from_chars(name.data() + digits, name.data() + name.size(), format.bits);
  if (wrong != std::errc{} || !is_mosaic_name(format.mosaic)) return {};
  const std::string_view rest = name.substr(static_cast<std::size_t>(end - name.data()));
  const int bits = format.bits;
  if (rest == "Packed" && (bits == 10 || bits == 12)) {
    format.packing = Packing::gige;
  } else if (rest == "p" && (bits == 10 || bits == 12 || bits == 14)) {
    format.packing = Packing::pfnc;
  } else if (!rest.empty() || (bits != 8 && bits != 10 && bits != 12 && bits != 14 && bits != 16)) {
    return {};
  }
  return format;
}

std::string unpacked_name(const std::string& name) {
  const auto format = parse_pixel_format(name);
  return format ? format->unpacked() : name;
}

std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes, int width_px, int height_px, int row_padding,
                                  const PixelFormat& format, const std::string& place) {
  const auto width = static_cast<std::size_t>(std::max(width_px, 0));
  const auto height = static_cast<std::size_t>(std::max(height_px, 0));
  // Without padding all rows are one.
  const bool apart = row_padding > 0 || format.packing == Packing::mipi;
  const std::size_t row_samples = apart ? width : width * height, rows = apart ? height : 1;
  const std::size_t stride = bytes_of(row_samples, format) + static_cast<std::size_t>(std::max(row_padding, 0));
  const std::size_t needed = rows == 0 ? 0 : (rows - 1) * stride + bytes_of(row_samples, format);
  if (bytes.size() < needed)
    throw Error(Exit::unavailable, place,
                gonio::format("%d x %d pixels of %s", width_px, height_px, format.unpacked().c_str()) + " are " +
                    std::to_string(needed) + " bytes, " + std::to_string(bytes.size()) + " came",
                {});
  std::vector<std::uint16_t> samples;
  samples.reserve(width * height);
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t* row = bytes.data() + y * stride;
    for (std::size_t i = 0; i < row_samples; ++i) {
      unsigned sample = 0;
      if (format.packing != Packing::whole)
        sample = packed_sample(row, i, format);
      else
        sample = format.bits == 8 ? row[i] : row[2 * i] | static_cast<unsigned>(row[2 * i + 1]) << 8U;
      samples.push_back(static_cast<std::uint16_t>(sample));
    }
  }
  const auto highest = samples.empty() ? samples.end() : std::max_element(samples.begin(), samples.end());
  if (highest != samples.end() && (*highest >> static_cast<unsigned>(format.bits)) != 0)
    throw Error(Exit::unavailable, place,
                "a sample of " + format.unpacked() + " is " + std::to_string(*highest) + ", above " +
                    std::to_string((1U << static_cast<unsigned>(format.bits)) - 1),
                "does the camera shift its samples? take a 16-bit or a packed format");
  return samples;
}

}  // namespace gonio::acquisition
