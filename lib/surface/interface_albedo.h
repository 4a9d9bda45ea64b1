// Directional-hemispherical reflectance of single scattering from a GGX interface to a dielectric of given f0 (exact
// Fresnel), tabulated once at first use.
//   E(cosine) = integral of F D G2 / (4 wiz woz) wiz d(wi),   mean = 2 integral of E(cosine) cosine d(cosine)
// Layers of light beneath are scaled by what the interface lets pass, 1 - E (Kelemen & Szirmay-Kalos 2001).
// Interpolation is linear in sqrt(cosine), log(alpha) and f0^(1/4); a `mean` is the exact integral of the interpolant,
// so that energy closes to rounding. Error against direct quadrature: below 2e-3, rms 5e-4 (f0 >= 0.001; 4e-3 below
// that). What all facets of a mirror, or both sides of an interface, lose: surface/interface_loss.h.
#pragma once
#include "geom/dual.h"

namespace gonio::surface {

inline constexpr double min_alpha = 0.02, max_alpha = 1,
                        max_dielectric_f0 = 0.2;  // range of the tables, clamped beyond

double dielectric_albedo(double cosine, double alpha, double f0);  // exactly zero at f0 = 0
double dielectric_albedo_mean(double alpha, double f0);

// The same with the slopes of the interpolant, to the right at its nodes; 0 where it is clamped.
struct AlbedoSlopes {
  double value = 0, by_alpha = 0, by_f0 = 0;
};
AlbedoSlopes dielectric_albedo_slopes(double cosine, double alpha, double f0);
AlbedoSlopes dielectric_albedo_mean_slopes(double alpha, double f0);

template <std::size_t N>
Dual<N> chained(const AlbedoSlopes& at, const Dual<N>& alpha, const Dual<N>& f0) {
  Dual<N> r(at.value);
  for (std::size_t i = 0; i < N; ++i) r.d[i] = at.by_alpha * alpha.d[i] + at.by_f0 * f0.d[i];
  return r;
}
template <std::size_t N>
Dual<N> dielectric_albedo(double cosine, const Dual<N>& alpha, const Dual<N>& f0) {
  return chained(dielectric_albedo_slopes(cosine, alpha.v, f0.v), alpha, f0);
}
template <std::size_t N>
Dual<N> dielectric_albedo_mean(const Dual<N>& alpha, const Dual<N>& f0) {
  return chained(dielectric_albedo_mean_slopes(alpha.v, f0.v), alpha, f0);
}

}  // namespace gonio::surface
