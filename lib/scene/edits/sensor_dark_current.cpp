// sensor.dark-current: of readings that grow with their exposure. Pictures here are in the unit of radiance, from which
// dark frames were taken off.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& sensor_dark_current();
}

namespace gonio::scene::edits {

const Edit& sensor_dark_current() {
  static const Edit edit{.mechanism = mechanism::sensor_dark_current, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
