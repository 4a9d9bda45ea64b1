// surface.sheen in tables of reflectance, as render has it: fibres that shine at grazing angles.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_sheen();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_sheen() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_sheen, .order = 55};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
