#include "io/volume_picture.h"

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/opencv_codecs.h"
#include "io/raster_header.h"
#include "io/volume_grid.h"

namespace gonio::io {
namespace {

cv::Mat decoded_codes(const std::string& bytes, const std::string& place) {
  cv::Mat picture;
  try {
    decode_by_opencv(bytes, cv::IMREAD_UNCHANGED, picture);
  } catch (const cv::Exception& failure) {
    refuse_volume(place, "cannot be decoded (" + failure.err + ")");
  }
  if (picture.empty()) refuse_volume(place, "cannot be decoded");
  return picture;
}

// The first channel of each pixel. Alpha, the second or the fourth, is no colour.
template <class Code>
void copy_grey(const cv::Mat& picture, std::vector<char>& to, const std::string& place) {
  const int channels = picture.channels(), colours = channels >= 3 ? 3 : 1;
  char* at = to.data();
  for (int y = 0; y < picture.rows; ++y) {
    const Code* row = picture.ptr<Code>(y);
    for (int x = 0; x < picture.cols; ++x, row += channels, at += sizeof(Code)) {
      for (int c = 1; c < colours; ++c)
        if (row[c] != row[0])
          refuse_volume(place,
                        "has colours, as at pixel (" + std::to_string(x) + ", " + std::to_string(y) +
                            "), and a volume has one value a voxel",
                        "write its one channel in grey");
      std::memcpy(at, row, sizeof(Code));
    }
  }
}

}  // namespace

bool is_tiff(std::string_view beginning) {
  using namespace std::string_view_literals;
  return beginning.starts_with("II*\0"sv) || beginning.starts_with("MM\0*"sv) || beginning.starts_with("II+\0"sv) ||
         beginning.starts_with("MM\0+"sv);
}

bool is_picture(std::string_view beginning) {
  return is_tiff(beginning) || beginning.starts_with("\x89PNG\r\n\x1a\n") || beginning.starts_with("\xff\xd8\xff") ||
         (beginning.starts_with("BM") && beginning.size() > 14 &&
          beginning.substr(6, 4) == std::string_view("\0\0\0\0", 4));
}

GreyCodes decode_grey_codes(const std::string& bytes, const std::string& place) {
  const RasterHeader header = read_raster_header(bytes, place);
  if (header.kind == RasterKind::jpeg)
    refuse_volume(place, "is a JPEG, which has lost what was measured",
                  "write the slices as PNG, or the volume as NRRD");
  check_decoded_size(header.width, header.height, 4 * sizeof(std::uint16_t), bytes.size(), place);
  const cv::Mat picture = decoded_codes(bytes, place);
  const bool wide = picture.depth() == CV_16U;
  if (!wide && picture.depth() != CV_8U) refuse_volume(place, "holds neither 8 nor 16-bit codes", "write it as NRRD");
  GreyCodes codes{static_cast<std::size_t>(picture.cols), static_cast<std::size_t>(picture.rows),
                  wide ? VoxelType::u16 : VoxelType::u8, std::vector<char>(picture.total() * (wide ? 2 : 1))};
  if (wide)
    copy_grey<std::uint16_t>(picture, codes.bytes, place);
  else
    copy_grey<std::uint8_t>(picture, codes.bytes, place);
  return codes;
}

}  // namespace gonio::io
