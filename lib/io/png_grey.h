// PNG of one channel of 8 bits, by libdeflate: half the time that libpng takes.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/raster_header.h"

namespace gonio::io {

// Rows from the top, of a file whose chunks read_raster_header() has found whole. Nothing for pictures of another kind,
// interlaced ones, and pixels that do not unpack to what the header claims: others may know better.
std::optional<std::vector<std::uint8_t>> decode_png_of_grey_bytes(std::string_view bytes, const RasterHeader& header);

// Rows from the top, `width` bytes each, as many as there are; the same bytes for the same picture. Of every row the
// filter counts whose differences are smallest in sum (ISO 15948, 12.8), of none, sub and up.
std::string encode_png_of_grey_bytes(std::span<const std::uint8_t> rows, std::size_t width);

std::uint32_t crc32_of(std::string_view bytes);

}  // namespace gonio::io
