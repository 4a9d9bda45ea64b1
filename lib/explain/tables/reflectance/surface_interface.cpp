// surface.interface in tables of reflectance, as render has it: a clear coat.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_interface();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_interface() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_interface, .order = 20};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
