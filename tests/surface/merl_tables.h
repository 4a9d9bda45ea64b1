// Tables in MERL format made from models that are isotropic. Cells that lie below the horizon are not measured.
#pragma once
#include <array>
#include <cmath>

#include "io/merl.h"
#include "surface/half_angle.h"
#include "surface/surface.h"

namespace gonio::tests {

inline surface::HalfAngles middle_of(const std::array<std::size_t, 3>& bins, std::size_t h, std::size_t d,
                                     std::size_t p) {
  const double u = (h + 0.5) / bins[0];
  return {u * u * pi / 2, (d + 0.5) / bins[1] * pi / 2, (p + 0.5) / bins[2] * pi};
}

template <class Brdf>
io::MerlTable merl_table_of(std::array<std::size_t, 3> bins, const Brdf& brdf) {
  io::MerlTable table{bins, {}};
  for (std::size_t h = 0; h < bins[0]; ++h)
    for (std::size_t d = 0; d < bins[1]; ++d)
      for (std::size_t p = 0; p < bins[2]; ++p) {
        const auto [wo, wi] = surface::directions_of(middle_of(bins, h, d, p));
        const bool seen = wo.z > 0 && wi.z > 0;
        const Rgb f = seen ? brdf(wo, wi) : Rgb{-1, -1, -1};
        for (int band = 0; band < 3; ++band) table.brdf_per_sr.push_back(static_cast<float>(f[band]));
      }
  return table;
}

// Varnish: GGX over a coloured base.
inline io::MerlTable varnish_table(std::array<std::size_t, 3> bins, double alpha) {
  const surface::Model& model = *surface::find("coated-diffuse");
  const auto values = surface::values_of(model,
                                         {{"albedo", manifest::Parameter({0.6, 0.3, 0.1})},
                                          {"f0", manifest::Parameter(0.05)},
                                          {"alpha", manifest::Parameter(alpha)}},
                                         "varnish");
  return merl_table_of(bins, [&](Vec3 wo, Vec3 wi) { return model.evaluate(values, wo, wi); });
}

}  // namespace gonio::tests
