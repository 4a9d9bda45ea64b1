// sensor.hot-pixel: charge that is gathered beside light's, and has its noise.
#include <cmath>

#include "render/link.h"

namespace gonio::mechanism {
const Mechanism& sensor_hot_pixel();
}

namespace gonio::render::links {

const Link& sensor_hot_pixel() {
  static const Link link{.mechanism = mechanism::sensor_hot_pixel,
                         .step = Step::light,
                         .order = 10,  // behind sensor.prnu, whose numbers stay what they are
                         .timed = [](std::span<const double> p, double exposure_s) -> OnValue {
                           return [share = p[0], gathered = p[1] * exposure_s](double v, const Site& at) {
                             const double drawn = at.fixed.uniform(), rate = -std::log(1 - at.fixed.uniform());
                             return drawn < share ? v + gathered * rate : v;
                           };
                         }};
  return link;
}

}  // namespace gonio::render::links
