// sensor.shutter: pictures that state their exposure.
#include "render/mechanisms/sensor_shutter.h"

#include "render/link.h"

namespace gonio::render::links {
namespace {

OnPicture expose(std::span<const double> p, double exposure_s) {
  if (!(exposure_s > 0)) return {};
  return [extra_s = p[0], exposure_s](io::Image& image) {
    for (float& v : image.data) v = static_cast<float>(equation::sensor_shutter(v, extra_s, exposure_s));
  };
}

}  // namespace

const Link& sensor_shutter() {
  static const Link link{.mechanism = mechanism::sensor_shutter, .step = Step::optics, .order = 10, .picture = expose};
  return link;
}

}  // namespace gonio::render::links
