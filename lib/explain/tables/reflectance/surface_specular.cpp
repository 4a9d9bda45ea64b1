// surface.specular in tables of reflectance, as render has it: a second lobe.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_specular();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_specular() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_specular, .order = 30};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
