// optics.veiling-glare: the mean of each channel.
#include "render/mechanisms/optics_veiling_glare.h"

#include <vector>

#include "render/link.h"

namespace gonio::render::links {
namespace {

OnPicture veil(std::span<const double> p, double) {
  return [share = p[0]](io::Image& image) {
    const std::size_t channels = image.channels.size();
    std::vector<double> sums(channels);
    for (std::size_t i = 0; i < image.data.size(); ++i) sums[i % channels] += image.data[i];
    for (std::size_t i = 0; i < image.data.size(); ++i)
      image.data[i] = static_cast<float>(equation::optics_veiling_glare(
          image.data[i], share, sums[i % channels] / static_cast<double>(image.pixels())));
  };
}

}  // namespace

const Link& optics_veiling_glare() {
  static const Link link{
      .mechanism = mechanism::optics_veiling_glare, .step = Step::optics, .order = 30, .picture = veil};
  return link;
}

}  // namespace gonio::render::links
