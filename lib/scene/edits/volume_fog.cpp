// volume.fog: media that fill the space between surfaces are none of this path tracer's.
#include "scene/mechanisms/volume_fog.h"

#include "scene/edit.h"

namespace gonio::scene::edits {

const Edit& volume_fog() {
  static const Edit edit{.mechanism = mechanism::volume_fog, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
