// volume.fog on one sight line: what is left of light that crosses the air, and what the air itself sends to the eye.
// Scattering is the same in all directions. Of light that went from a lamp to the place where it is scattered, or to a
// surface, the half of what was scattered before that goes on forwards still arrives: it is lost with
//   sigma_f = sigma_t (1 - albedo / 2)                                       two streams: Schuster 1905
// A single scattering to the eye: Blinn 1982; Sun, Ramamoorthi, Narasimhan & Nayar 2005, equation 7. Of light that
// arrives from surfaces and air all around, half a sphere is taken to look like the picture in the mean.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& volume_fog();
}

namespace gonio::equation {

// Of light that went `way_m` through it.
inline double volume_fog_passes(double sigma_t_per_m, double way_m) {
  return std::exp(-sigma_t_per_m * way_m);
}

inline double volume_fog_lost_per_m(double sigma_t_per_m, double albedo) {
  return sigma_t_per_m * std::max(0.0, 1 - albedo / 2);
}

// Radiance that the air over the first `way_m` from `eye_m` along the unit vector `along` sends back of a lamp of 1
// W/sr at `lamp_m`, in 1/m^2:
//   albedo sigma_t / (4 pi) integral_0^way exp(-sigma_t s - sigma_f r) / r^2 ds,   r = |eye + s along - lamp|
// by equiangular points: with s = s0 + h tan(theta) the integrand is smooth however near the line passes the lamp.
inline double volume_fog_glow(double sigma_t_per_m, double albedo, Vec3 eye_m, Vec3 along, double way_m, Vec3 lamp_m) {
  constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                          0.9602898564975363};  // Gauss & Legendre, eight
  constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                            0.1012285362903763};
  const Vec3 arm = lamp_m - eye_m;
  const double s0 = dot(arm, along), h = std::max(1e-6, norm(arm - along * s0));
  const double first = std::atan(-s0 / h), last = std::atan((way_m - s0) / h), half = (last - first) / 2;
  const double lost = volume_fog_lost_per_m(sigma_t_per_m, albedo);
  double sum = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    const double x = k < 4 ? node[k] : -node[k - 4], theta = (first + last) / 2 + half * x;
    sum += weight[k % 4] * std::exp(-sigma_t_per_m * (s0 + h * std::tan(theta)) - lost * h / std::cos(theta));
  }
  return albedo * sigma_t_per_m / (4 * pi * h) * half * sum;
}

// The same of a distant lamp of 1 W/m^2, whose way through the air is not known: not dimmed before.
inline double volume_fog_glow(double sigma_t_per_m, double albedo, double way_m) {
  return albedo * (1 - std::exp(-sigma_t_per_m * way_m)) / (4 * pi);
}

// Of light from all around, as bright as the picture's mean over half of the sphere: radiance over that mean.
inline double volume_fog_veil(double sigma_t_per_m, double albedo, double way_m) {
  return albedo / 2 * (1 - std::exp(-sigma_t_per_m * way_m));
}

}  // namespace gonio::equation
