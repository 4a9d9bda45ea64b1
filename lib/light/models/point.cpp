// A small lamp that shines equally in all directions; with radius_m > 0 (mechanism light.finite-size) it is the sphere
// light.
#include "light/sphere_emitter.h"

namespace gonio::light {

const Model& point() {
  static const SphereLamp model(
      "point", "A lamp too small to cast a penumbra; its irradiance falls with the square of the distance.",
      "Lambert 1760; with radius_m > 0 as `sphere`", "where the lamp is, in the world frame", 0,
      "radius of the lamp; 0 is a point");
  return model;
}

}  // namespace gonio::light
