// geometry.contact: the object sinks into what it stands on.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& geometry_contact();
}

namespace gonio::scene::edits {
namespace {

void sink(Instance& instance, std::span<const double> a) {
  instance.world_from_object.translation_m.z -= a[0];
}

}  // namespace

const Edit& geometry_contact() {
  static const Edit edit{.mechanism = mechanism::geometry_contact, .instance = sink};
  return edit;
}

}  // namespace gonio::scene::edits
