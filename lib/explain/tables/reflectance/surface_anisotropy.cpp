// surface.anisotropy in tables of reflectance, as render has it: gloss with a direction.
#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_anisotropy();
}

namespace gonio::explain::tables::reflectance {

const ReflectanceBinding& surface_anisotropy() {
  static const ReflectanceBinding binding{
      .mechanism = mechanism::surface_anisotropy, .order = 40, .each_switches = true};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
