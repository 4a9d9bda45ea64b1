// 8 and 16-bit PNG, JPEG and TIFF, 8-bit BMP and TGA, behind io/picture.h.
#pragma once
#include <filesystem>
#include <string>

#include "io/grey.h"
#include "io/image.h"

namespace gonio::io {

// `bytes`: a whole file; `place` names it in errors. Codes over full scale, channels R,G,B or Y; alpha is left out.
Image decode_raster(const std::string& bytes, const std::string& place);
GreyImage decode_grey(const std::string& bytes, const std::string& place);
// R,G,B where the image has them, else its first channel; clipped to [0, 1] and rounded to 8 or 16 bits.
std::string encode_raster_png(const Image& image, int code_bits = 8);

enum class PictureFormat { exr, raster };
PictureFormat picture_format(const std::filesystem::path& path);  // by extension; Error(data) for others

}  // namespace gonio::io
