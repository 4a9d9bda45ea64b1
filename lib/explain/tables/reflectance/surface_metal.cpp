// surface.metal in tables of reflectance, as render has it: bare metal.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_metal();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_metal() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_metal, .order = 45};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
