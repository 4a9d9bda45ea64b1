// Paths of unpolarized light; see path_loop.h.
#include "render/path_integrator.h"

namespace gonio::render {

std::unique_ptr<Integrator> unpolarized_integrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                                                   const Transport& transport) {
  return std::make_unique<PathIntegrator<Unpolarized>>(scene, view, caster, transport);
}

}  // namespace gonio::render
