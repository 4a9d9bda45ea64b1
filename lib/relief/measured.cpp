#include "relief/measured.h"

namespace gonio::relief {

Measured measured(const io::HeightMap& map, const Treatment& treatment, const std::string& name) {
  Measured m{name, treatment, treated(map, treatment, name), {}, {}};
  m.roughness = roughness(m.surface.map);
  m.normals = normals_of(m.surface.map);
  return m;
}

}  // namespace gonio::relief
