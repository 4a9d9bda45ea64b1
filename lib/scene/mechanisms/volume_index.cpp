// volume.index: the refractive index is not the believed one. Equation: explain/tables/models/volume.cpp. In scenes the
// index is a parameter of the surface (eta), which render takes as it stands.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& volume_index() {
  static const Mechanism declaration{
      .id = "volume.index",
      .sentence = "The material's refractive index differs from the believed one.",
      .typical = "0.008 in eta",
      .equation = "eta' = eta + shift",
      .source = "Snell 1621; Fresnel 1823",
      .stage = "transport",
      .target = Target::surface,
      .domains = {"tables", "traced"},
      .parameters = {{.name = "shift",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.01,
                      .typical = 0.008,
                      .meaning = "added to the base model's index"}},
      .conditions = {"surface.incidence-angle", "light.wavelength"},
      .mistaken_for = {{.with = "geometry.offset", .told_apart = "caliper"},
                       {.with = "volume.dispersion", .told_apart = "narrow bands"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
