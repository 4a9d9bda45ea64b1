// Fresnel's amplitude coefficients with their phases, for light that meets a smooth interface to a medium of the
// complex relative index eta = (n2 + i k2) / n1. Born & Wolf 1999, sections 1.5.2, 1.5.4 and 14.2.
//
// Fields vary as exp(-i omega t), so that k > 0 absorbs and a phase grows where light is delayed. Directions in which p
// components count: y = cross(d, s) for each of the three rays, s the common normal of the plane of incidence
// (optics/mueller.h); at normal incidence r_p = -r_s. With w = eta cos(theta_t) = sqrt(eta^2 - sin^2(theta_i)),
// Im w >= 0 (the field behind the interface decays):
//   r_s = (c - w) / (c + w),         t_s = 2 c / (c + w)
//   r_p = (eta^2 c - w) / (eta^2 c + w),   t_p = 2 eta c / (eta^2 c + w)
#pragma once
#include <algorithm>
#include <cmath>
#include <complex>

namespace gonio::optics {

using Complex = std::complex<double>;
struct Amplitudes {
  Complex s, p;
};

// w above. The square root of what has no imaginary part is +i |.| below zero: total reflection.
inline Complex refracted(double cosine, Complex eta) {
  const Complex squared = eta * eta - (1 - cosine * cosine);
  if (squared.imag() == 0 && squared.real() < 0) return {0, std::sqrt(-squared.real())};
  const Complex root = std::sqrt(squared);
  return root.imag() < 0 ? -root : root;
}

// `cosine` of the angle of incidence, in [0, 1].
inline Amplitudes reflected_amplitudes(double cosine, Complex eta) {
  const double c = std::clamp(cosine, 0.0, 1.0);
  const Complex w = refracted(c, eta), e = eta * eta * c;
  if (c == 0) return {-1, -1};
  return {(c - w) / (c + w), (e - w) / (e + w)};
}
inline Amplitudes transmitted_amplitudes(double cosine, Complex eta) {
  const double c = std::clamp(cosine, 0.0, 1.0);
  const Complex w = refracted(c, eta);
  if (c == 0) return {0, 0};
  return {2 * c / (c + w), 2.0 * eta * c / (eta * eta * c + w)};
}

}  // namespace gonio::optics
