// surface.coating: a film on what was taken for bare. Equation: surface/thin_film.h (amplitudes).
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_coating() {
  static const Mechanism declaration{
      .id = "surface.coating",
      .sentence = "A transparent film on a smooth surface changes how its reflection is polarized.",
      .typical = "a quarter of a wave, 0.1 um of magnesium fluoride; 5 to 100 nm of oxide, grease or water",
      .equation =
          "r_s, r_p = (r01 + r12 e) / (1 + r01 r12 e), e = exp(i 4 pi film_eta film_m cos_t / wavelength), in the "
          "Mueller matrix of the reflection",
      .source = "Azzam & Bashara 1977, section 4.3; Born & Wolf 1999, section 7.6.1",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables", "polarization"},
      .parameters = {{.name = "film_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.2e-6,
                      .start = 0.05e-6,
                      .typical = 0.1e-6,
                      .meaning = "thickness of the film"},
                     {.name = "film_eta",
                      .unit = "1",
                      .neutral = 1.38,
                      .lower = 1.2,
                      .upper = 2.4,
                      .start = 1.38,
                      .typical = 0.2,
                      .meaning = "index of refraction of the film; without effect where it has no thickness"}},
      .conditions = {"light.wavelength", "surface.incidence-angle"},
      .mistaken_for = {{.with = "volume.index", .told_apart = "another wavelength, another angle"},
                       {.with = "surface.roughness", .told_apart = "a film keeps the degree of polarization"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
