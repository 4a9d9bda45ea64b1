// optics.bloom: the halo of each channel.
#include "render/mechanisms/optics_bloom.h"

#include "base/parallel.h"
#include "render/halo.h"
#include "render/link.h"

namespace gonio::render::links {
namespace {

OnPicture bloom(std::span<const double> p, double) {
  return [share = p[0], radius = p[1]](io::Image& image) {
    if (share == 0) return;
    const Halo halo(image, {&radius, 1});
    const double own = Halo::own_share(radius);
    parallel_for(0, static_cast<std::size_t>(image.height), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < image.width; ++x) {
        const std::vector<double> around = halo.around(x, y);
        for (std::size_t c = 0; c < around.size(); ++c) {
          float& v = image.at(x, y, static_cast<int>(c));
          v = static_cast<float>(equation::optics_bloom(v, share, around[c] + own * v));
        }
      }
    });
  };
}

}  // namespace

const Link& optics_bloom() {
  static const Link link{.mechanism = mechanism::optics_bloom, .step = Step::optics, .order = 25, .picture = bloom};
  return link;
}

}  // namespace gonio::render::links
