// sensor.black-offset: with or without light.
#include "render/mechanisms/sensor_black_offset.h"

#include "render/link.h"

namespace gonio::render::links {

const Link& sensor_black_offset() {
  static const Link link{.mechanism = mechanism::sensor_black_offset,
                         .step = Step::dark,
                         .value = [](std::span<const double> p) -> OnValue {
                           return [offset = p[0]](double v, const Site&) {
                             return equation::sensor_black_offset(v, offset);
                           };
                         }};
  return link;
}

}  // namespace gonio::render::links
