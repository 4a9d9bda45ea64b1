// Pictures from and to files: OpenEXR (linear floats) and 8/16-bit PNG, JPEG, TIFF, BMP, TGA. The
// extension says which of the two, a file's beginning which codec.
#pragma once
#include <filesystem>

#include "io/image.h"

namespace gonio::io {

// EXR: all channels of part 0, half or float, by their own names; alphabetical as in the file, but a plain R, G, B
// come first in this order. 8/16-bit files: codes over full scale, [0, 1], NOT linearised, channels R,G,B or Y.
// Sizes in the header are checked against the file's length before anything is allocated. Error(no_input | data).
Image read_picture(const std::filesystem::path& path);

// EXR as 32-bit float with ZIP compression (byte-identical for identical pixels); .png: 8 bit, values clipped to [0, 1]
// and rounded, no transfer curve applied. Written atomically.
void write_picture(const std::filesystem::path& path, const Image& image);

// The PNG file's bytes (for embedding in a page), 8 bit.
std::string encode_png(const Image& image);

float srgb_from_linear(float v);  // IEC 61966-2-1, defined beyond [0, 1] by odd symmetry
float linear_from_srgb(float v);

}  // namespace gonio::io
