// Pixel formats of cameras by the names that they give them, and their bytes as samples. Names and layouts: EMVA's
// Pixel Format Naming Convention 2.4, sections 4 to 7, and GigE Vision 1.2, section 26, whose "Packed" formats are laid
// out in another way than the "p" formats of the former; Linux's formats that end in P are packed as MIPI CSI-2 does.
// Polarization mosaics have the names that their makers gave them.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::acquisition {

struct PixelFormat {
  enum class Packing {
    whole,  // Mono8: a byte each; Mono10 to Mono16: two bytes each, the lower first, unused bits 0
    pfnc,   // Mono12p: bit after bit, the lowest of each sample first, filled into bytes from their lowest bit on
    gige,   // Mono12Packed: two samples in three bytes: high bits of the first, low bits of both, high bits of the
            // second
    mipi,   // no name of GenICam's: high bits of four samples (12 bit: two), a byte each, then their low bits, the
            // lowest of the first sample first; every row begins anew
  };
  std::string mosaic;  // "Mono", "BayerRG", "Polarized", "BayerRGPolarized", ...
  int bits = 8;
  Packing packing = Packing::whole;

  std::string unpacked() const { return mosaic + std::to_string(bits); }  // "Mono12"
  int bits_per_pixel() const;  // as they lie in memory: 12 for Mono10Packed, 16 for Mono10
};

// Nothing for colours, for depths and for names that are not known.
std::optional<PixelFormat> parse_pixel_format(std::string_view name);
// Upper left corner of a Bayer grid as the manifest's cameras state it, row by row: "RGGB" of "BayerRG"; else empty.
std::string bayer_corner(const std::string& mosaic);
// "BayerRG12Packed": "BayerRG12"; what is not known stays as it is.
std::string unpacked_name(const std::string& name);

// Row by row. `row_padding`: bytes after each row; where it is 0 a row of packed samples may begin within a byte.
// Error(unavailable) at `place` where bytes are missing, or where a sample has bits that its format does not have.
std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes, int width_px, int height_px, int row_padding,
                                  const PixelFormat& format, const std::string& place);

}  // namespace gonio::acquisition
