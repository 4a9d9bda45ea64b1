// Pictures as 8 and 16-bit codes: how many bits a file holds, and PNG files with either number.
#pragma once
#include <filesystem>

#include "io/image.h"

namespace gonio::io {

int code_bits(const std::filesystem::path& path);  // 8 or 16; 0: OpenEXR. Error(no_input | data)
// Values clipped to [0, 1] and rounded to `code_bits`, 8 or 16; no transfer curve. Written atomically.
void write_png(const std::filesystem::path& path, const Image& image, int code_bits);

}  // namespace gonio::io
