// transport.indirect: a factor on light that was scattered more than once.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& transport_indirect();
}

namespace gonio::scene::edits {
namespace {

void scale_indirect(Appearance& appearance, const Amounts& amounts, Vec3, const std::string&) {
  appearance.indirect_strength = amounts[0];
}

}  // namespace

const Edit& transport_indirect() {
  static const Edit edit{.mechanism = mechanism::transport_indirect, .appearance = scale_indirect};
  return edit;
}

}  // namespace gonio::scene::edits
