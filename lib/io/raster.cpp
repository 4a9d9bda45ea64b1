// 8 and 16-bit pictures by OpenCV's codecs, TGA by io/tga.h, PNG of grey bytes by io/png_grey.h. IMREAD_UNCHANGED:
// neither the camera's orientation tag nor a colour profile is applied, so that a pixel keeps the place and the code
// that the sensor gave it.
#include "io/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/error.h"
#include "io/opencv_codecs.h"
#include "io/png_grey.h"
#include "io/raster_header.h"
#include "io/tga.h"

namespace gonio::io {
namespace {

void decode(const std::string& bytes, const std::string& place, int flags, cv::Mat& picture) {
  bool decoded = false;
  try {
    decoded = !decode_by_opencv(bytes, flags, picture).empty();
  } catch (const cv::Exception& failure) {
    throw Error(Exit::data, place, "cannot be decoded (" + failure.err + ")", "export or copy it again");
  }
  if (!decoded) throw Error(Exit::data, place, "the pixels cannot be decoded", "export or copy it again");
}

cv::Mat mat_of(const TgaCodes& tga) {  // OpenCV's order of channels is TGA's
  return cv::Mat(tga.height, tga.width, CV_8UC(tga.channels), const_cast<std::uint8_t*>(tga.codes.data())).clone();
}

// The weights that OpenCV's decoders have, in steps of 2^-14.
GreyImage grey_of_codes(const TgaCodes& tga) {
  GreyImage grey{tga.width, tga.height, {}, {}};
  if (tga.channels == 1) {
    grey.bytes = tga.codes;
    return grey;
  }
  grey.bytes.reserve(tga.codes.size() / 3);
  for (std::size_t i = 0; i < tga.codes.size(); i += 3)
    grey.bytes.push_back(static_cast<std::uint8_t>(
        (1868 * tga.codes[i] + 9617 * tga.codes[i + 1] + 4899 * tga.codes[i + 2] + 8192) >> 14));
  return grey;
}

template <class Code>
Image scaled(const cv::Mat& picture) {
  constexpr float full_scale = std::numeric_limits<Code>::max();
  const int stored = picture.channels(), kept = stored >= 3 ? 3 : 1;
  Image image(picture.cols, picture.rows,
              kept == 3 ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"});
  float* value = image.data.data();
  for (int y = 0; y < picture.rows; ++y) {
    const Code* code = picture.ptr<Code>(y);
    for (int x = 0; x < picture.cols; ++x, code += stored)
      for (int c = kept - 1; c >= 0; --c) *value++ = static_cast<float>(code[c]) / full_scale;  // OpenCV: B, G, R
  }
  return image;
}

template <class Code>
Code code(float value) {
  const double clipped = std::clamp(std::isnan(value) ? 0.0 : static_cast<double>(value), 0.0, 1.0);
  return static_cast<Code>(std::lround(clipped * std::numeric_limits<Code>::max()));
}

template <class Code>
void fill(const Image& image, const std::vector<int>& sources, cv::Mat& picture) {
  const int count = static_cast<int>(sources.size());
  for (int y = 0; y < image.height; ++y) {
    auto* row = picture.ptr<Code>(y);
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < count; ++c)
        row[x * count + c] = code<Code>(image.at(x, y, sources[static_cast<std::size_t>(c)]));
  }
}

}  // namespace

Image decode_raster(const std::string& bytes, const std::string& place) {
  const RasterHeader header = read_raster_header(bytes, place);
  check_decoded_size(header.width, header.height, 3 * sizeof(float), bytes.size(), place);
  if (header.kind == RasterKind::tga) return scaled<std::uint8_t>(mat_of(decode_tga(bytes, place)));
  cv::Mat picture;
  decode(bytes, place, cv::IMREAD_UNCHANGED, picture);
  if (picture.depth() == CV_8U) return scaled<std::uint8_t>(picture);
  if (picture.depth() == CV_16U) return scaled<std::uint16_t>(picture);
  throw Error(Exit::data, place, "holds neither 8 nor 16-bit codes", "export floats as OpenEXR");
}

GreyImage decode_grey(const std::string& bytes, const std::string& place) {
  const RasterHeader header = read_raster_header(bytes, place);
  check_decoded_size(header.width, header.height, 3 * sizeof(float), bytes.size(), place);
  if (header.kind == RasterKind::tga) return grey_of_codes(decode_tga(bytes, place));
  GreyImage grey{static_cast<int>(header.width), static_cast<int>(header.height), {}, {}};
  if (auto own = decode_png_of_grey_bytes(bytes, header)) {
    grey.bytes = std::move(*own);
    return grey;
  }
  grey.bytes.resize(header.width * header.height);
  cv::Mat picture(grey.height, grey.width, CV_8U, grey.bytes.data());  // filled in place where the file has 8 bits
  decode(bytes, place, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION, picture);
  if (picture.depth() == CV_16U) return grey_of(scaled<std::uint16_t>(picture));
  if (picture.type() != CV_8U || picture.cols != grey.width || picture.rows != grey.height) {
    throw Error(Exit::data, place, "holds neither 8 nor 16-bit codes", "export floats as OpenEXR");
  }
  if (picture.data != grey.bytes.data()) std::copy_n(picture.ptr(), grey.bytes.size(), grey.bytes.data());
  return grey;
}

std::string encode_raster_png(const Image& image, int code_bits) {
  const bool colour = image.channel("R") >= 0 && image.channel("G") >= 0 && image.channel("B") >= 0;
  const std::vector<int> sources =  // in OpenCV's order
      colour ? std::vector<int>{image.channel("B"), image.channel("G"), image.channel("R")} : std::vector<int>{0};
  const int count = static_cast<int>(sources.size());
  cv::Mat picture(image.height, image.width, code_bits == 16 ? CV_16UC(count) : CV_8UC(count));
  if (code_bits == 16)
    fill<std::uint16_t>(image, sources, picture);
  else
    fill<std::uint8_t>(image, sources, picture);
  std::vector<std::uint8_t> bytes;
  if (picture.empty() || !encode_by_opencv(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6}))
    throw Error(Exit::internal, "PNG",
                "a picture of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                    " pixels cannot be encoded");
  return {bytes.begin(), bytes.end()};
}

}  // namespace gonio::io
