// Truevision's TGA (Truevision TGA File Format Specification 2.0, 1991): grey of 8 bits, colour of 15, 16, 24 and 32,
// colour maps; plain or run-length coded; any corner first. Alpha is left out.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/raster_header.h"

namespace gonio::io {

// The format has no signature: a head that no other could be meant by. For what is known to be none of the others.
bool is_tga(std::string_view bytes);
// Error(data) at `place` where the file cannot hold the pixels that its head claims, or holds none of these kinds.
RasterHeader read_tga_header(std::string_view bytes, const std::string& place);

struct TgaCodes {
  int width = 0, height = 0;
  int channels = 1;                 // or 3: blue, green, red
  std::vector<std::uint8_t> codes;  // rows from the top
};
TgaCodes decode_tga(std::string_view bytes, const std::string& place);

}  // namespace gonio::io
