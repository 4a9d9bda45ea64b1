// sensor.exposure: a factor on single pictures.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& sensor_exposure();
}

namespace gonio::scene::edits {

const Edit& sensor_exposure() {
  static const Edit edit{.mechanism = mechanism::sensor_exposure, .picture = [](const Amounts& p) { return 1 + p[0]; }};
  return edit;
}

}  // namespace gonio::scene::edits
