// See v4l2_formats.h.
#include "acquisition/device/v4l2_formats.h"

#include <algorithm>
#include <array>

namespace gonio::acquisition {
namespace {

using Packing = PixelFormat::Packing;

struct KnownFormat {
  const char *letters, *mosaic;
  int bits;
  Packing packing;
};
// Whole ones first: of two that hold the same they cost less to take apart.
constexpr std::array known_formats{
    KnownFormat{"GREY", "Mono", 8, Packing::whole},     KnownFormat{"Y10 ", "Mono", 10, Packing::whole},
    KnownFormat{"Y12 ", "Mono", 12, Packing::whole},    KnownFormat{"Y14 ", "Mono", 14, Packing::whole},
    KnownFormat{"Y16 ", "Mono", 16, Packing::whole},    KnownFormat{"BA81", "BayerBG", 8, Packing::whole},
    KnownFormat{"GBRG", "BayerGB", 8, Packing::whole},  KnownFormat{"GRBG", "BayerGR", 8, Packing::whole},
    KnownFormat{"RGGB", "BayerRG", 8, Packing::whole},  KnownFormat{"BG10", "BayerBG", 10, Packing::whole},
    KnownFormat{"GB10", "BayerGB", 10, Packing::whole}, KnownFormat{"BA10", "BayerGR", 10, Packing::whole},
    KnownFormat{"RG10", "BayerRG", 10, Packing::whole}, KnownFormat{"BG12", "BayerBG", 12, Packing::whole},
    KnownFormat{"GB12", "BayerGB", 12, Packing::whole}, KnownFormat{"BA12", "BayerGR", 12, Packing::whole},
    KnownFormat{"RG12", "BayerRG", 12, Packing::whole}, KnownFormat{"BG14", "BayerBG", 14, Packing::whole},
    KnownFormat{"GB14", "BayerGB", 14, Packing::whole}, KnownFormat{"GR14", "BayerGR", 14, Packing::whole},
    KnownFormat{"RG14", "BayerRG", 14, Packing::whole}, KnownFormat{"BYR2", "BayerBG", 16, Packing::whole},
    KnownFormat{"GB16", "BayerGB", 16, Packing::whole}, KnownFormat{"GR16", "BayerGR", 16, Packing::whole},
    KnownFormat{"RG16", "BayerRG", 16, Packing::whole}, KnownFormat{"Y10P", "Mono", 10, Packing::mipi},
    KnownFormat{"Y12P", "Mono", 12, Packing::mipi},     KnownFormat{"Y14P", "Mono", 14, Packing::mipi},
    KnownFormat{"pBAA", "BayerBG", 10, Packing::mipi},  KnownFormat{"pGAA", "BayerGB", 10, Packing::mipi},
    KnownFormat{"pgAA", "BayerGR", 10, Packing::mipi},  KnownFormat{"pRAA", "BayerRG", 10, Packing::mipi},
    KnownFormat{"pBCC", "BayerBG", 12, Packing::mipi},  KnownFormat{"pGCC", "BayerGB", 12, Packing::mipi},
    KnownFormat{"pgCC", "BayerGR", 12, Packing::mipi},  KnownFormat{"pRCC", "BayerRG", 12, Packing::mipi},
    KnownFormat{"pBEE", "BayerBG", 14, Packing::mipi},  KnownFormat{"pGEE", "BayerGB", 14, Packing::mipi},
    KnownFormat{"pgEE", "BayerGR", 14, Packing::mipi},  KnownFormat{"pREE", "BayerRG", 14, Packing::mipi}};

}  // namespace

std::string letters_of(std::uint32_t code) {
  std::string letters;
  for (unsigned i = 0; i < 4; ++i) letters += static_cast<char>(code >> 8 * i & 0xFF);
  return letters;
}

std::optional<PixelFormat> format_of_fourcc(std::uint32_t code) {
  const std::string letters = letters_of(code);
  const auto found = std::ranges::find_if(known_formats, [&](const KnownFormat& f) { return letters == f.letters; });
  if (found == known_formats.end()) return {};
  return PixelFormat{found->mosaic, found->bits, found->packing};
}

}  // namespace gonio::acquisition
