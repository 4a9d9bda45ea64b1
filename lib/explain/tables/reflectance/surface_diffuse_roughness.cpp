// surface.diffuse-roughness in tables of reflectance, as render has it: a rough base.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_diffuse_roughness();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_diffuse_roughness() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_diffuse_roughness, .order = 10};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
