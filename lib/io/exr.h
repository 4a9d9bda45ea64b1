// OpenEXR, behind io/picture.h.
#pragma once
#include <string>

#include "io/image.h"

namespace gonio::io {

// `bytes`: a whole EXR file; `place` names it in errors. Part 0, scan lines or tiles, every channel as float.
Image decode_exr(const std::string& bytes, const std::string& place);
std::string encode_exr(const Image& image);  // float channels, ZIP; identical pixels give identical bytes

}  // namespace gonio::io
