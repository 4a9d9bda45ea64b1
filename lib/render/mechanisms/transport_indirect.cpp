// transport.indirect: surfaces light each other. Equation: render/path_tracer.cpp; as polynomials,
// render/geometry_cache.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& transport_indirect() {
  static const Mechanism declaration{
      .id = "transport.indirect",
      .sentence = "Light reaches a surface by way of other surfaces, and not from the lamp alone.",
      .typical = "1 to 20 %",
      .equation = "L = L_direct + strength L_indirect, L_indirect all light that was scattered more than once",
      .source = "Kajiya 1986, equation 1; Goral et al. 1984",
      .stage = "transport",
      .target = Target::scene,
      .domains = {"images"},
      .parameters = {{.name = "strength",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 2,
                      .start = 1,
                      .typical = 1,
                      .meaning = "factor on interreflected light; 1 is what the albedos and the geometry imply"}},
      .conditions = {"scene.indirect-irradiance", "light.visibility", "image.radiance"},
      .mistaken_for = {{.with = "light.ambient", .told_apart = "black cloth over the neighbours, or the lamp off"},
                       {.with = "surface.subsurface", .told_apart = "a spot of light on a flat part"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
