// Refraction by Snell's law; `eta` is the index beyond over the index on wo's side.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::surface {

// Relative indices closer to one than this leave light as it is.
inline constexpr double matched_step = 1e-5;
inline bool matched(double eta) {
  return std::abs(eta - 1) < matched_step;
}

// Where light that leaves towards wo comes from, through a facet of normal h, wo.h > 0. No total reflection assumed.
inline Vec3 refracted(Vec3 wo, Vec3 h, double eta) {
  const double c = dot(wo, h), t2 = 1 - (1 - c * c) / (eta * eta);
  const Vec3 w = h * (c / eta - std::sqrt(std::max(0.0, t2))) - wo / eta;
  return normalized(w);
}

// Normal of the facet that refracts light from wi (beyond) to wo, on wo's side; the zero vector where none does.
inline Vec3 refracting_normal(Vec3 wo, Vec3 wi, double eta) {
  const Vec3 sum = wo + wi * eta;
  const double length = norm(sum);
  if (!(length > 0)) return {};
  const Vec3 h = sum / (sum.z < 0 ? -length : length);
  return dot(wo, h) > 0 && dot(wi, h) < 0 ? h : Vec3{};
}

}  // namespace gonio::surface
