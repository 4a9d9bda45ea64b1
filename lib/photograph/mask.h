// Masks: pictures that say which pixels of a photograph count.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/image.h"

namespace gonio::photograph {

// Pixels above 0.5 count; the first channel decides. 1 per pixel that counts.
struct Mask {
  int width = 0, height = 0;
  std::vector<std::uint8_t> counts;
};
Mask read_mask(const std::filesystem::path& path);

// The mask of `picture`, one entry per pixel. Error(data) at `place` where it has another size.
std::vector<std::uint8_t> read_mask_of(const io::Image& picture, const std::filesystem::path& path,
                                       const std::string& place);

}  // namespace gonio::photograph
