#include "render/preview.h"

#include <algorithm>

#include "io/picture.h"

namespace gonio::render {

io::Image preview(const io::Image& linear) {
  io::Image image(linear.width, linear.height, {"R", "G", "B"});
  std::vector<float> largest(linear.pixels());
  const std::size_t colours = std::min<std::size_t>(linear.channels.size(), 3);  // a mosaic has one
  for (std::size_t i = 0; i < linear.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float v = linear.data[i * linear.channels.size() + std::min(c, colours - 1)];
      image.data[3 * i + c] = v;
      largest[i] = std::max(largest[i], v);
    }
  const auto white = largest.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(largest.size() - 1));
  std::nth_element(largest.begin(), white, largest.end());
  const float scale = *white > 0 ? 1 / *white : 1;
  for (float& v : image.data) v = std::clamp(io::srgb_from_linear(std::max(0.0f, v * scale)), 0.0f, 1.0f);
  return image;
}

}  // namespace gonio::render
