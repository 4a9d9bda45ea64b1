// volume.dispersion: the index depends on the wavelength. Equation: explain/tables/models/volume.cpp. In scenes
// spectral indices are files of the surface (`spectra`), which render takes as they stand.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& volume_dispersion() {
  static const Mechanism declaration{
      .id = "volume.dispersion",
      .sentence = "The refractive index falls with the wavelength: colours are bent differently.",
      .typical = "0.008 in eta over the visible range",
      .equation = "eta' = eta + cauchy_m2 (1 / lambda^2 - 1 / (589.3 nm)^2)",
      .source = "Cauchy 1836, two terms, about the sodium line",
      .stage = "transport",
      .target = Target::surface,
      .domains = {"tables"},
      .parameters = {{.name = "cauchy_m2",
                      .unit = "m^2",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 5e-14,
                      .start = 4e-15,
                      .typical = 2e-15,
                      .meaning = "Cauchy's second coefficient"}},
      .conditions = {"light.wavelength", "surface.incidence-angle"},
      .mistaken_for = {{.with = "geometry.offset", .told_apart = "narrow bands"},
                       {.with = "lens.lateral-colour", .told_apart = "the same picture without the object"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
