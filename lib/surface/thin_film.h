// Reflectance of a smooth interface under a transparent film, for unpolarised light from air. With n0 = 1, n1 the
// film's index, n2 = eta that of the substrate, c the cosines inside each and d the thickness, for each polarization
//   R = (r01^2 + r12^2 + 2 r01 r12 cos(p)) / (1 + r01^2 r12^2 + 2 r01 r12 cos(p)),   p = 4 pi n1 d c1 / wavelength
//   r_s = (na ca - nb cb) / (na ca + nb cb),  r_p = (nb ca - na cb) / (nb ca + na cb)
// Born & Wolf 1999, section 7.6.1 (Airy's sum) and 1.5.2. Indices of at least one; no absorption.
//
// Amplitudes, for ellipsometry, where the substrate absorbs: indices n - i k, waves exp(+i w t), r_p of the sign that
// makes it -r_s at normal incidence (Azzam & Bashara 1977, section 4.3; the Nebraska convention), by the same sum
//   r = (r01 + r12 e) / (1 + r01 r12 e),   e = exp(-i 4 pi n1 d c1 / wavelength).
#pragma once
#include <algorithm>
#include <cmath>
#include <complex>

#include "geom/vector.h"

namespace gonio::surface {

inline double fresnel_film(double cosine, double eta, double film_eta, double film_m, double wavelength_m) {
  const double c0 = std::clamp(cosine, 1e-9, 1.0), s2 = 1 - c0 * c0;
  const double n1 = film_eta, n2 = eta;
  const double c1 = std::sqrt(1 - s2 / (n1 * n1)), c2 = std::sqrt(std::max(0.0, 1 - s2 / (n2 * n2)));
  const double fringe = 2 * std::cos(4 * pi * n1 * film_m * c1 / wavelength_m);
  const auto airy = [&](double above, double below) {
    const double both = above * below * fringe;
    return (above * above + below * below + both) / (1 + above * above * below * below + both);
  };
  const double s = airy((c0 - n1 * c1) / (c0 + n1 * c1), (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2));
  const double p = airy((n1 * c0 - c1) / (n1 * c0 + c1), (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2));
  return std::clamp((s + p) / 2, 0.0, 1.0);
}

struct FilmAmplitudes {
  std::complex<double> s, p;
};
// film_m = 0: the bare substrate.
inline FilmAmplitudes film_amplitudes(double cosine, std::complex<double> substrate, double film_eta, double film_m,
                                      double wavelength_m) {
  using Complex = std::complex<double>;
  const double c0 = std::clamp(cosine, 1e-9, 1.0), s2 = 1 - c0 * c0;
  const Complex n1 = film_m > 0 ? Complex(film_eta) : substrate, n2 = substrate;
  const Complex c1 = std::sqrt(1.0 - s2 / (n1 * n1)), c2 = std::sqrt(1.0 - s2 / (n2 * n2));
  const Complex fringe = std::exp(Complex(0, -4 * pi * film_m / wavelength_m) * n1 * c1);
  const auto airy = [&](Complex above, Complex below) {
    return (above + below * fringe) / (1.0 + above * below * fringe);
  };
  return {airy((c0 - n1 * c1) / (c0 + n1 * c1), (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2)),
          airy((n1 * c0 - c1) / (n1 * c0 + c1), (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2))};
}

}  // namespace gonio::surface
