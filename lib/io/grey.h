// Grey pictures for searching large photographs: one byte a pixel straight from the decoder where the file has no
// more to say, which is several times as fast as floats of three channels (picture.h).
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "io/image.h"

namespace gonio::io {

struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  // rows from the top
  std::vector<float> values;        // the same before rounding, 0 to 255; empty for 8-bit files, of which bytes say all
};

// Luminance weights 0.299, 0.587, 0.114 as for 8-bit video; JPEG: its own luminance. Orientation tags are not applied.
// EXR and 16-bit files as by grey_of(). Error(no_input | data) as read_picture().
GreyImage read_grey(const std::filesystem::path& path);

// Does the file hold one channel of 8 bits, as its first bytes tell? PNG alone; of others: no.
bool is_grey_of_8_bits(const std::filesystem::path& path);

// Values beyond [0, 1], and those that all stay below 1/8 (12 bits in a file of 16), are scaled by their 99.5th
// percentile; what is no number is black.
GreyImage grey_of(const Image& image);

}  // namespace gonio::io
