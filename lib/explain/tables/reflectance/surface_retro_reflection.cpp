// surface.retro-reflection in tables of reflectance, as render has it: light that returns.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_retro_reflection();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_retro_reflection() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_retro_reflection, .order = 50};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
