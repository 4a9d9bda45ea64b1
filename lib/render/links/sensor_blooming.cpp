// sensor.blooming: charge before it is counted, behind the filters: a neighbour's colour does not matter.
#include "render/mechanisms/sensor_blooming.h"

#include "render/link.h"

namespace gonio::render::links {
namespace {

OnPicture spill(std::span<const double> p, double) {
  return [along = p[0], across = p[1], full_scale = p[2]](io::Image& image) {
    const io::Image gathered = image;
    const auto at = [&](int x, int y, int c) {
      const bool inside = x >= 0 && y >= 0 && x < image.width && y < image.height;
      return inside ? double{gathered.at(x, y, c)} : 0;
    };
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < static_cast<int>(image.channels.size()); ++c)
          image.at(x, y, c) = static_cast<float>(
              equation::sensor_blooming(gathered.at(x, y, c), along, across, full_scale,
                                        {at(x, y - 1, c), at(x, y + 1, c), at(x - 1, y, c), at(x + 1, y, c)}));
  };
}

}  // namespace

const Link& sensor_blooming() {
  static const Link link{.mechanism = mechanism::sensor_blooming, .step = Step::charge, .picture = spill};
  return link;
}

}  // namespace gonio::render::links
