// What other renderers know of a camera: a centred projection without distortion.
#pragma once
#include "scene/scene.h"

namespace gonio::scene {

struct Lens {
  bool orthographic = false;
  double fx = 0, fy = 0;  // px; orthographic: px per metre
  double cx = 0, cy = 0;  // px
  int width = 0, height = 0;
  double distortion_px = 0;  // largest distance over the picture between where the camera and these numbers see a point
};
// From the rays alone: focal lengths are those on the axis.
Lens lens_of(const View& view);

// Eye, a point straight ahead at 1 m, and the direction of the picture's top, in world coordinates.
struct Stand {
  Vec3 eye, target, up;
};
Stand stand_of(const View& view);

}  // namespace gonio::scene
