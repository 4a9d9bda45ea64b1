// optics.ghost: the sharp picture, turned about its centre.
#include "render/mechanisms/optics_ghost.h"

#include "render/link.h"

namespace gonio::render::links {
namespace {

OnPicture lay_over(std::span<const double> p, double) {
  return [share = p[0]](io::Image& image) {
    const io::Image sharp = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < static_cast<int>(image.channels.size()); ++c)
          image.at(x, y, c) = static_cast<float>(
              equation::optics_ghost(sharp.at(x, y, c), share, sharp.at(image.width - 1 - x, image.height - 1 - y, c)));
  };
}

}  // namespace

const Link& optics_ghost() {
  static const Link link{.mechanism = mechanism::optics_ghost, .step = Step::optics, .order = 20, .picture = lay_over};
  return link;
}

}  // namespace gonio::render::links
