// Sheen: light that fibres standing on a surface send back at grazing angles.
//   velvet(wo, wi) = D G / (4 wiz woz), facets whose normals lie near the horizon:
//     D(h) = exp(-cot^2(theta_h) / w^2) / (pi w^2 sin^4(theta_h)),  integral of D cos = 1        after Ashikhmin,
//     G = min(1, 2 hz woz / (wo.h), 2 hz wiz / (wo.h))              "Distribution-based BRDFs", 2007, as in Cycles
//   forward(wo, wi) = pi (1 - wo.h)^5, strongest where lamp and eye face each other across the surface: Burley 2012,
//     "Physically Based Shading at Disney", section 5.5, without its colour
// Both are reciprocal and return less than they receive.
#pragma once
#include <algorithm>
#include <cmath>

#include "surface/microfacet.h"

namespace gonio::surface {

inline constexpr double least_sheen_width = 0.1, largest_sheen_width = 1.5;

inline double velvet(Vec3 wo, Vec3 wi, double width) {
  const Vec3 h = half_vector(wo, wi);
  const double z2 = h.z * h.z, sine2 = 1 - z2, w2 = width * width, across = half_cosine(wo, wi);
  if (!(sine2 > 1e-12) || !(across > 0)) return 0;
  const double facets = std::exp(-z2 / (sine2 * w2)) / (pi * w2 * sine2 * sine2);
  // G / (4 wiz woz), which stays finite where both directions graze.
  return facets * std::min(1 / (4 * wo.z * wi.z), h.z / (2 * across * std::max(wo.z, wi.z)));
}

inline double forward_sheen(Vec3 wo, Vec3 wi) {
  const double c = 1 - half_cosine(wo, wi), c2 = c * c;
  return pi * c2 * c2 * c;
}

// Directional-hemispherical reflectances, from tables, to 1e-2 of one.
double velvet_albedo(double cosine, double width);
double forward_sheen_albedo(double cosine);

}  // namespace gonio::surface
