// sensor.saturation: the last that happens to a reading.
#include "render/mechanisms/sensor_saturation.h"

#include "render/link.h"

namespace gonio::render::links {

const Link& sensor_saturation() {
  static const Link link{.mechanism = mechanism::sensor_saturation,
                         .step = Step::reading,
                         .value = [](std::span<const double> p) -> OnValue {
                           return [full_scale = p[0]](double v, const Site&) {
                             return equation::sensor_saturation(v, full_scale);
                           };
                         }};
  return link;
}

}  // namespace gonio::render::links
