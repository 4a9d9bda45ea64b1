// sensor.row-pattern: rows are counted from the top.
#include "render/mechanisms/sensor_row_pattern.h"

#include "render/link.h"

namespace gonio::render::links {

const Link& sensor_row_pattern() {
  static const Link link{.mechanism = mechanism::sensor_row_pattern,
                         .step = Step::signal,
                         .order = 20,
                         .value = [](std::span<const double> p) -> OnValue {
                           return [pattern = equation::row_pattern(p)](double v, const Site& at) {
                             return equation::sensor_row_pattern(v, pattern, at.row);
                           };
                         }};
  return link;
}

}  // namespace gonio::render::links
