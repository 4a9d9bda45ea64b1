// sensor.non-linearity: the camera's one response.
#include "render/mechanisms/sensor_non_linearity.h"

#include "render/link.h"

namespace gonio::render::links {

const Link& sensor_non_linearity() {
  static const Link link{.mechanism = mechanism::sensor_non_linearity,
                         .step = Step::signal,
                         .order = 10,
                         .value = [](std::span<const double> p) -> OnValue {
                           return [response = equation::sensor_non_linearity(p)](double v, const Site&) {
                             return response(v);
                           };
                         }};
  return link;
}

}  // namespace gonio::render::links
