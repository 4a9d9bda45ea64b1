// light.ambient: uniform surroundings.
#include "light/mechanisms/light_ambient.h"

#include "scene/edit.h"

namespace gonio::scene::edits {
namespace {

void surround(Appearance& appearance, const Amounts& amounts, Vec3, const std::string& place) {
  if (amounts == Amounts{0, 0, 0}) {
    appearance.ambient = nullptr;
    return;
  }
  appearance.ambient = light::find("uniform")->prepare({{"radiance", manifest::Parameter(amounts)}}, {}, place);
}

}  // namespace

const Edit& light_ambient() {
  static const Edit edit{.mechanism = mechanism::light_ambient, .appearance = surround};
  return edit;
}

}  // namespace gonio::scene::edits
