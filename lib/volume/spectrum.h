// Intensities of a spectrum behind matter, and line integrals that are linear in its length.
//
// Attenuations over a spectrum are taken to be gamma-distributed about one attenuation length with the relative
// variance v: T = E exp(-a p) = (1 + v p)^(-1/v), which has two numbers where a polynomial of the logarithm has more; a
// tungsten tube of 120 kV on glass has about 1, photons of one energy 0. What makes readings linear in the length is
// its inverse.
#pragma once
#include <cmath>

namespace gonio::volume {

inline constexpr double usual_variance = 0.8;

inline double intensity_behind(double p, double v) {
  return v > 0 ? std::pow(1 + v * p, -1 / v) : std::exp(-p);
}
inline double line_integral_of(double intensity, double v) {
  return v > 0 ? (std::pow(intensity, -v) - 1) / v : -std::log(intensity);
}
// The logarithm that is not made linear.
inline double logarithm_behind(double p, double v) {
  return v > 0 ? std::log1p(v * p) / v : p;
}

}  // namespace gonio::volume
