// Fresnel reflectance of unpolarised light at a smooth interface to a dielectric or a metal, seen from air (index 1).
// `cosine` is that of the angle between the direction and the interface's normal, in [0, 1].
// Born & Wolf 1999, section 1.5 (dielectric) and 14.2 (metal); Schlick 1994, equation 15.
// Numbers T of the interface: double, or geom/dual.h where slopes are asked for.
#pragma once
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "geom/vector.h"

namespace gonio::surface {

// Relative index with the given reflectance at normal incidence, f0 = ((eta - 1) / (eta + 1))^2; f0 < 1.
template <class T>
requires(!std::is_integral_v<T>) T eta_of_f0(const T& f0) {
  using std::sqrt;
  const T r = sqrt(f0);
  return (1 + r) / (1 - r);
}

// eta: the index beyond over the index on this side. Total reflection is 1. Exactly zero for eta = 1.
template <class T>
requires(!std::is_integral_v<T>) T fresnel_dielectric(double cosine, const T& eta) {
  using std::sqrt;
  if (eta == 1.0) return T(0);
  const double c = std::clamp(cosine, 0.0, 1.0);
  const T t2 = 1 - (1 - c * c) / (eta * eta);  // squared cosine beyond
  if (t2 <= 0.0) return T(1);
  const T t = sqrt(t2);
  const T s = (c - eta * t) / (c + eta * t), p = (eta * c - t) / (eta * c + t);
  return (s * s + p * p) / 2;
}

// Reflectance of a smooth interface to diffuse light from outside, 2 integral of F(c) c dc; eta >= 1. Duntley 1942, as
// in Egan & Hilgeman 1979, "Optical Properties of Inhomogeneous Materials", appendix.
template <class T>
requires(!std::is_integral_v<T>) T fresnel_dielectric_mean(const T& eta) {
  using std::log;
  constexpr double near = 1.001;  // the closed form cancels below
  if (eta < near) return eta > 1.0 ? fresnel_dielectric_mean(near) * (eta - 1) / (near - 1) : T(0);
  const T n = eta, n2 = n * n, n4 = n2 * n2, p = n2 + 1, m = n2 - 1;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) + n2 * m * m / (p * p * p) * log((n - 1) / (n + 1)) -
         2 * n2 * n * (n2 + 2 * n - 1) / (p * (n4 - 1)) + 8 * n4 * (n4 + 1) / (p * (n4 - 1) * (n4 - 1)) * log(n);
}

// Complex index eta + i k.
template <class T>
requires(!std::is_integral_v<T>) T fresnel_metal(double cosine, const T& eta, const T& k) {
  using std::sqrt;
  const double c = std::clamp(cosine, 0.0, 1.0), c2 = c * c, s2 = 1 - c2;
  const T d = eta * eta - k * k - s2;
  const T ab = sqrt(d * d + 4 * eta * eta * k * k);  // a^2 + b^2, (a + i b)^2 = (eta + i k)^2 - sin^2
  const T a = sqrt(std::max(T(0.0), (ab + d) / 2));
  const T s = (ab + c2 - 2 * a * c) / (ab + c2 + 2 * a * c);
  const T p = s * (c2 * ab + s2 * s2 - 2 * a * c * s2) / (c2 * ab + s2 * s2 + 2 * a * c * s2);
  return std::clamp((s + p) / 2, T(0.0), T(1.0));
}

// Whole numbers are taken as what they stand for.
inline double eta_of_f0(double f0) {
  return eta_of_f0<double>(f0);
}
inline double fresnel_dielectric(double cosine, double eta) {
  return fresnel_dielectric<double>(cosine, eta);
}
inline double fresnel_dielectric_mean(double eta) {
  return fresnel_dielectric_mean<double>(eta);
}
inline double fresnel_metal(double cosine, double eta, double k) {
  return fresnel_metal<double>(cosine, eta, k);
}

inline double schlick_rise(double cosine) {
  const double m = std::clamp(1 - cosine, 0.0, 1.0), m2 = m * m;
  return m2 * m2 * m;
}
inline Rgb fresnel_schlick(double cosine, Rgb f0) {
  return f0 + (Rgb{1, 1, 1} - f0) * schlick_rise(cosine);
}

}  // namespace gonio::surface
