// surface.thin-film: interference in a film on the interface. Equation: surface/thin_film.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_thin_film() {
  static const Mechanism declaration{
      .id = "surface.thin-film",
      .sentence = "A transparent film lies on the glossy interface, and its interference colours the gloss.",
      .typical = "the gloss changes by factors between wavelengths; films of 0.02 to 0.66 um are told apart by range",
      .equation =
          "R = |(r1 + r2 e) / (1 + r1 r2 e)|^2 for both polarizations, e = exp(i 4 pi film_eta film_m cos_t / "
          "wavelength), instead of the Fresnel factor of the gloss",
      .source = "Born & Wolf 1999, section 7.6.1, equation 60 (Airy); Belcour & Barla 2017",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables"},
      .parameters = {{.name = "film_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.66e-6,
                      .start = 3e-7,
                      .typical = 3e-7,
                      .meaning = "thickness of the film"},
                     {.name = "film_eta",
                      .unit = "1",
                      .neutral = 1.4,
                      .lower = 1.15,
                      .upper = 2.4,
                      .start = 1.4,
                      .typical = 0.3,
                      .meaning = "index of refraction of the film; without effect where it has no thickness"}},
      .conditions = {"surface.wavelength", "surface.difference-angle", "surface.half-angle"},
      .mistaken_for = {{.with = "light.spectrum", .told_apart = "narrow bands and another angle"},
                       {.with = "surface.fluorescence", .told_apart = "tilt the sample: the colours of a film move"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
