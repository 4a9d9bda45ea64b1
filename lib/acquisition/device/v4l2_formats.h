// Video4Linux's formats of raw sensors by their four letters (The Linux Media Infrastructure userspace API, "Raw Bayer
// Formats", "Luma-Only Formats"), with the names that the laboratory's description gives them.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "acquisition/device/unpack.h"

namespace gonio::acquisition {

std::optional<PixelFormat> format_of_fourcc(std::uint32_t code);
std::string letters_of(std::uint32_t code);  // "RG10"

}  // namespace gonio::acquisition
