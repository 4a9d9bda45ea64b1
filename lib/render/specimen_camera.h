// The virtual camera that sees the built-in scenes.
#pragma once
#include "manifest/image_list.h"

namespace gonio::render {

// An image that "camera" is to take, with the noise of its virtual sensor.
inline void add_view(manifest::Document& document, manifest::PlannedImage view) {
  view.camera = "camera";
  view.noise = manifest::Noise{.gain = 16000, .read = 0.0005};
  manifest::enter_image(document, view);
}

}  // namespace gonio::render
