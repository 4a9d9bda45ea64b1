// surface.fluorescence: light that is absorbed returns at longer wavelengths. render does not simulate it: its paths
// carry every band by itself.
#include "surface/mechanisms/surface_fluorescence.h"

namespace gonio::mechanism {

const Mechanism& surface_fluorescence() {
  static const Mechanism declaration{
      .id = "surface.fluorescence",
      .sentence = "The matte base absorbs short wavelengths and emits longer ones: brightener, dye, fluorescent paint.",
      .typical = "1 to 30 % of the light in the emission band",
      .equation =
          "f = f + emission excitation exp(-(wavelength - emission_centre_m)^2 / (2 emission_width_m^2)) / pi, "
          "excitation: power of the light in the exciting band over that in the band of the table",
      .source = "Donaldson 1954; Hullin et al. 2010, section 3",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables", "images"},
      .parameters = {{.name = "emission",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.1,
                      .typical = 0.1,
                      .meaning = "share of the exciting power that returns per band at the centre"},
                     {.name = "emission_centre_m",
                      .unit = "m",
                      .neutral = 5e-7,
                      .lower = 4e-7,
                      .upper = 7e-7,
                      .start = 5e-7,
                      .typical = 1e-7,
                      .meaning = "wavelength at which most is emitted; without effect where nothing is"},
                     {.name = "emission_width_m",
                      .unit = "m",
                      .neutral = 3e-8,
                      .lower = 1e-8,
                      .upper = 1e-7,
                      .start = 3e-8,
                      .typical = 3e-8,
                      .meaning = "standard deviation of the emitted band"}},
      .conditions = {"surface.excitation", "surface.wavelength"},
      .mistaken_for = {{.with = "light.spectrum", .told_apart = "a filter that takes the ultraviolet away"},
                       {.with = "surface.thin-film", .told_apart = "tilt the sample: the colour of a dye stays"}},
      .inputs = {{.name = "wavelength", .unit = "m", .lower = 3.8e-7, .upper = 7.8e-7},
                 {.name = "excitation", .unit = "1", .lower = 0, .upper = 10}},
      .act =
          [](double f, std::span<const double> at, std::span<const double> p) {
            return f + equation::surface_fluorescence(p[0], p[1], p[2], at[0]) * at[1];
          },
  };
  return declaration;
}

}  // namespace gonio::mechanism
