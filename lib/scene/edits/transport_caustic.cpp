// transport.caustic: render finds all that there is by itself; a share of it is a matter of explain alone.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& transport_caustic();
}

namespace gonio::scene::edits {

const Edit& transport_caustic() {
  static const Edit edit{.mechanism = mechanism::transport_caustic, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
