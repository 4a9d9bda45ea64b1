// sensor.clipped-resampling: beyond the picture's border there is what lies on it.
#include "render/mechanisms/sensor_clipped_resampling.h"

#include <algorithm>

#include "render/link.h"
#include "render/mechanisms/sensor_saturation.h"

namespace gonio::render::links {
namespace {

OnPicture resample(std::span<const double> p, double) {
  if (!(p[0] > 0)) return {};
  return [full_scale = p[0], width_px = p[1]](io::Image& image) {
    const io::Image native = image;
    const auto weight = [&](int offset) { return equation::sensor_clipped_resampling(offset, width_px); };
    const auto reading = [&](int x, int y, int c) {
      return equation::sensor_saturation(
          native.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1), c), full_scale);
    };
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < static_cast<int>(image.channels.size()); ++c) {
          double sum = 0;
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) sum += weight(dx) * weight(dy) * reading(x + dx, y + dy, c);
          image.at(x, y, c) = static_cast<float>(sum);
        }
  };
}

}  // namespace

const Link& sensor_clipped_resampling() {
  static const Link link{
      .mechanism = mechanism::sensor_clipped_resampling, .step = Step::resampling, .picture = resample};
  return link;
}

}  // namespace gonio::render::links
