// Which carrier a rendering needs; the paths themselves are in path_loop.h.
#include "render/path_integrator.h"

namespace gonio::render {

std::unique_ptr<Integrator> path_integrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                                            const Transport& transport) {
  if (transport.stokes) return polarized_integrator(scene, view, caster, transport);
  return unpolarized_integrator(scene, view, caster, transport);
}

}  // namespace gonio::render
