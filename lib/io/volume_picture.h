// Pictures as slices: grey codes as they are stored, without a scale.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/volume.h"

namespace gonio::io {

bool is_tiff(std::string_view beginning);
bool is_picture(std::string_view beginning);  // PNG, BMP, TIFF; JPEG too, to refuse it by its name

struct GreyCodes {
  std::size_t width = 0, height = 0;
  VoxelType type = VoxelType::u8;
  std::vector<char> bytes;  // in this machine's order, rows from the top
};

// PNG, BMP or TIFF (its first page) of 8 or 16 bits. A picture in colours counts as grey where its channels are equal
// everywhere. Error(data) for colours, for a JPEG, whose codes are not those that were measured, and for what its head
// claims beyond its bytes.
GreyCodes decode_grey_codes(const std::string& bytes, const std::string& place);

}  // namespace gonio::io
