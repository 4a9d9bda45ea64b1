// What fills the inside of an object: a homogeneous medium. Per band; coefficients per metre.
//   attenuation over a path d: exp(-(sigma_a + sigma_s) d) (Bouguer 1729); phase function of Henyey & Greenstein 1941
//   with asymmetry g
#pragma once
#include "geom/vector.h"

namespace gonio::surface {

struct Medium {
  Rgb eta{1, 1, 1};  // refractive index, real part
  Rgb sigma_a_per_m, sigma_s_per_m, g;
  bool scatters() const { return max_component(sigma_s_per_m) > 0; }
  bool absorbs() const { return max_component(sigma_a_per_m) > 0; }
  bool disperses() const { return eta.x != eta.y || eta.y != eta.z; }
};

}  // namespace gonio::surface
