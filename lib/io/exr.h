// OpenEXR, behind io/picture.h.
#pragma once
#include <map>
#include <string>

#include "io/image.h"

namespace gonio::io {

// `bytes`: a whole EXR file; `place` names it in errors. Part 0, scan lines or tiles, every channel as float.
Image decode_exr(const std::string& bytes, const std::string& place);

using ExrAttributes = std::map<std::string, std::string>;  // texts in the header
// Float channels, ZIP; identical pixels and attributes give identical bytes.
std::string encode_exr(const Image& image, const ExrAttributes& attributes = {});
ExrAttributes exr_attributes(const std::string& bytes, const std::string& place);  // those that are texts

}  // namespace gonio::io
