// optics.bloom: a lens scatters a share of the light into a halo about every point.
#include "render/mechanisms/optics_bloom.h"

namespace gonio::mechanism {

const Mechanism& optics_bloom() {
  static const Mechanism declaration{
      .id = "optics.bloom",
      .sentence =
          "Dust, haze or the lens' own glass scatter a share of the light into a halo about every bright place.",
      .typical = "0.5 to 10 % of the light",
      .equation =
          "v += share (halo - v), halo = v * k over the picture, k(r) = (1 + r^2 / radius_px^2)^(-3/2) / (2 pi "
          "radius_px^2)",
      .source =
          "Talvala et al. 2007, the part of the glare spread function that falls with distance; the profile is "
          "Moffat's "
          "(1969) with beta = 3/2",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"images"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.4,
                      .start = 0.02,
                      .typical = 0.03,
                      .meaning = "share of the light that goes into the halo"},
                     {.name = "radius_px",
                      .unit = "px",
                      .neutral = 4,
                      .lower = 1,
                      .upper = 40,
                      .start = 4,
                      .typical = 4,
                      .meaning = "where the halo has fallen to 35 % of its middle"}},
      .conditions = {"image.edge-distance", "image.radiance", "image.mean"},
      .mistaken_for = {{.with = "optics.veiling-glare",
                        .told_apart = "photograph a bright edge: a halo falls with the distance from it"},
                       {.with = "optics.defocus", .told_apart = "stop the lens down: a halo stays as it is"},
                       {.with = "sensor.non-linearity",
                        .told_apart =
                            "photograph the same at several exposures: a halo grows in proportion, a bend moves"}},
      .inputs = {{.name = "halo", .unit = "W/(m^2 sr)", .lower = 0, .upper = 10}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return equation::optics_bloom(v, p[0], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
