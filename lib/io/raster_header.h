// What the headers of PNG, JPEG, TIFF, BMP and TGA files claim, read without a decoder and without allocating what they
// claim.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace gonio::io {

enum class RasterKind { png, jpeg, tiff, bmp, tga };

struct RasterHeader {
  std::uint64_t width = 0, height = 0;
  int code_bits = 8;  // 16 where the file says so; fewer than 8 are read as 8
  RasterKind kind = RasterKind::png;
};

// Error(data) at `place` for a file that is none of these, is cut off or has a damaged structure.
RasterHeader read_raster_header(std::string_view bytes, const std::string& place);

// Refuses a picture whose `pixel_bytes` once decoded cannot come from a file of `file_bytes`: above a size that harms
// nobody, a factor beyond what any compression of a real picture reaches; and above an absolute limit, always.
void check_decoded_size(std::uint64_t width, std::uint64_t height, std::uint64_t pixel_bytes, std::uint64_t file_bytes,
                        const std::string& place);

}  // namespace gonio::io
