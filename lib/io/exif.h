// What a camera wrote into a JPEG of how it was taken (Exif 2.3, sections 4.6.5 to 4.6.7), read by libexif.
#pragma once
#include <filesystem>
#include <optional>

namespace gonio::io {

struct Exif {
  std::optional<double> exposure_s, f_number, iso;
};
// All empty for files without Exif, and for numbers that are not above zero.
Exif exif_of(const std::filesystem::path& path);

}  // namespace gonio::io
