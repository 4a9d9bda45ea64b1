// Paths of polarized light: planes s1, s2, s3 beside the radiance; see path_loop.h and polarized_carrier.h.
#include "render/path_integrator.h"
#include "render/polarized_carrier.h"

namespace gonio::render {

std::unique_ptr<Integrator> polarized_integrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                                                 const Transport& transport) {
  return std::make_unique<PathIntegrator<Polarized>>(scene, view, caster, transport);
}

}  // namespace gonio::render
