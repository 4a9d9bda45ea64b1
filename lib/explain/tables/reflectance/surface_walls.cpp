// surface.walls in tables of reflectance, as render has it: facets with walls.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_walls();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_walls() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_walls, .order = 70};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
