// sensor.crosstalk: the three bands of one pixel; behind polarizers a sample and those beside it.
#include "render/mechanisms/sensor_crosstalk.h"

#include "photograph/polarizer_array.h"
#include "render/link.h"

namespace gonio::render::links {
namespace {

OnPicture mix(std::span<const double> p, double) {
  return [share = p[0]](io::Image& image) {
    for (std::size_t i = 0; i + 2 < image.data.size(); i += 3) {
      const double sum = double{image.data[i]} + image.data[i + 1] + image.data[i + 2];
      for (std::size_t c = 0; c < 3; ++c)
        image.data[i + c] = static_cast<float>(equation::sensor_crosstalk(image.data[i + c], share, sum));
    }
  };
}

void share(std::span<const double> p, photograph::PolarizerArray& array) {
  array.share = p[0];
}

}  // namespace

const Link& sensor_crosstalk() {
  static const Link link{
      .mechanism = mechanism::sensor_crosstalk, .step = Step::optics, .order = 40, .picture = mix, .polarizers = share};
  return link;
}

}  // namespace gonio::render::links
