// optics.vignetting: all views alike (scene/scene.h, vignetting()).
#include "scene/mechanisms/optics_vignetting.h"

#include "scene/edit.h"

namespace gonio::scene::edits {
namespace {

void vignette(Appearance& appearance, const Amounts& amounts, Vec3, const std::string&) {
  appearance.vignetting_falloff = amounts[0];
}

}  // namespace

const Edit& optics_vignetting() {
  static const Edit edit{.mechanism = mechanism::optics_vignetting, .appearance = vignette};
  return edit;
}

}  // namespace gonio::scene::edits
