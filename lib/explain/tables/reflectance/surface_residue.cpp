// surface.residue in tables of reflectance, as render has it: what is left between the lobes.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_residue();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_residue() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_residue, .order = 60};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
