// A luminous sphere: uniform radiance watt_per_sr / (pi radius_m^2), so that far away it acts as the point light of
// that intensity.
#include "light/sphere_emitter.h"

namespace gonio::light {

const Model& sphere() {
  static const SphereLamp model("sphere", "A luminous sphere, which casts a penumbra and shows as a disk in mirrors.",
                                "Shirley, Wang & Zimmerman 1996, section 3.2.1",
                                "centre of the sphere, in the world frame", std::nullopt,
                                "radius of the sphere; 0 is a point");
  return model;
}

}  // namespace gonio::light
