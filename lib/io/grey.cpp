// Floats to grey; files to grey by the decoder of raster.h.
#include "io/grey.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string_view>

#include "base/atomic_file.h"
#include "io/picture.h"
#include "io/raster.h"

namespace gonio::io {
namespace {

// A picture that stays below is one of 12 or fewer bits in a file of 16: raw frames keep the sensor's own numbers.
constexpr float least_range = 1.0F / 8;

float white_level(const std::vector<float>& values) {
  const float high = values.empty() ? 0 : *std::ranges::max_element(values);
  if (high <= 0 || (high <= 1 && high >= least_range)) return 1;
  std::vector<float> sorted = values;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at > 0 ? *at : high;
}

}  // namespace

GreyImage grey_of(const Image& image) {
  const int r = image.channel("R"), g = image.channel("G"), b = image.channel("B");
  const bool colour = r >= 0 && g >= 0 && b >= 0;
  GreyImage grey{image.width, image.height, {}, {}};
  grey.values.reserve(image.pixels());
  const std::size_t channels = image.channels.size();
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float* pixel = &image.data[i * channels];
    const float v = colour ? 0.299F * pixel[r] + 0.587F * pixel[g] + 0.114F * pixel[b] : pixel[0];
    grey.values.push_back(std::isfinite(v) ? std::max(v, 0.0F) : 0.0F);
  }
  const float scale = 255.0F / white_level(grey.values);
  grey.bytes.reserve(image.pixels());
  for (float& v : grey.values) {
    v = std::min(255.0F, v * scale);
    grey.bytes.push_back(static_cast<std::uint8_t>(std::lround(v)));
  }
  return grey;
}

GreyImage read_grey(const std::filesystem::path& path) {
  if (picture_format(path) == PictureFormat::exr) return grey_of(read_picture(path));
  return decode_grey(read_file(path), path.string());
}

bool is_grey_of_8_bits(const std::filesystem::path& path) {
  std::array<char, 26> head{};
  std::ifstream file(path, std::ios::binary);
  if (!file.read(head.data(), head.size()) || std::string_view(head.data(), 8) != "\x89PNG\r\n\x1a\n") return false;
  return head[24] == 8 && head[25] == 0;  // bits, and the colour type of one channel without a palette
}

}  // namespace gonio::io
