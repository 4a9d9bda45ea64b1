// sensor.prnu: n(pixel) from the numbers that belong to the pixel of the camera.
#include "render/mechanisms/sensor_prnu.h"

#include "render/link.h"

namespace gonio::render::links {

const Link& sensor_prnu() {
  static const Link link{
      .mechanism = mechanism::sensor_prnu, .step = Step::light, .value = [](std::span<const double> p) -> OnValue {
        return [sigma = p[0]](double v, const Site& at) { return equation::sensor_prnu(v, sigma, at.fixed.normal()); };
      }};
  return link;
}

}  // namespace gonio::render::links
