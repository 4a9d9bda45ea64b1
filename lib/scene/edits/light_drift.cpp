// light.drift: all lamps alike, by the time of each image.
#include "light/mechanisms/light_drift.h"

#include "scene/edit.h"

namespace gonio::scene::edits {

const Edit& light_drift() {
  static const Edit edit{.mechanism = mechanism::light_drift, .lamps = [](const Amounts& p, const Moment& at) {
                           return Rgb{1, 1, 1} * equation::light_drift(p[0], p[1], at.since_s);
                         }};
  return edit;
}

}  // namespace gonio::scene::edits
