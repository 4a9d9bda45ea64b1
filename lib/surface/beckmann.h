// Visible slopes of a Beckmann surface of unit roughness. Slopes x towards the eye and y across it have the density
// exp(-x^2 - y^2) / pi; a facet of slope x is seen by the direction (sin t, 0, cos t) with the area cos t - x sin t
// where that is positive. Along x the visible ones have the distribution N(x) / N(cot t),
//   N(x) = cos t (1 + erf x) / 2 + sin t exp(-x^2) / (2 sqrt(pi)),   dN/dx = (cos t - x sin t) exp(-x^2) / sqrt(pi)
// (Heitz & d'Eon 2014, section 5.2), which is inverted by Newton's method between brackets.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/dual.h"
#include "geom/vector.h"

namespace gonio::surface {

inline constexpr double inverse_root_pi = 0.56418958354775628695;

// c (1 + erf(c / s)) / 2 + s exp(-(c / s)^2) / (2 sqrt(pi)), for c >= 0, s >= 0.
inline double beckmann_area_seen(double c, double s) {
  if (c > 6 * s) return c;
  const double a = c / s;
  return (c * (1 + std::erf(a)) + s * std::exp(-a * a) * inverse_root_pi) / 2;
}

// Of numbers with slopes: dP/dc = (1 + erf(c / s)) / 2, dP/ds = exp(-(c / s)^2) / (2 sqrt(pi)).
template <class C, std::size_t N>
Dual<N> beckmann_area_seen(const C& c, const Dual<N>& s) {
  const Dual<N> cosine(c);
  const double a = s.v > 0 ? cosine.v / s.v : 1e3;
  const double by_c = (1 + std::erf(a)) / 2, by_s = std::exp(-a * a) * inverse_root_pi / 2;
  Dual<N> r(beckmann_area_seen(cosine.v, s.v));
  for (std::size_t i = 0; i < N; ++i) r.d[i] = by_c * cosine.d[i] + by_s * s.d[i];
  return r;
}

// The slope below which lies a share u of what a direction of this cosine and sine sees.
inline double beckmann_visible_slope(double cosine, double sine, double u) {
  double low = -6, high = cosine < 6 * sine ? cosine / sine : 6;
  const auto seen = [&](double x) {
    return (cosine * (1 + std::erf(x)) + sine * std::exp(-x * x) * inverse_root_pi) / 2;
  };
  const double target = u * seen(high);
  double x = std::clamp(0.43 * std::log(u / (1 - u)) - 0.5 * sine, 0.9 * low, low + 0.95 * (high - low));
  for (int i = 0; i < 60; ++i) {
    const double beyond = seen(x) - target;
    (beyond > 0 ? high : low) = x;
    const double slope = (cosine - x * sine) * std::exp(-x * x) * inverse_root_pi;
    const double next = slope > 0 ? x - beyond / slope : high;
    const double kept = next > low && next < high ? next : (low + high) / 2;
    if (std::abs(kept - x) < 1e-12) return kept;
    x = kept;
  }
  return x;
}

// The normal of slopes x along v's projection and y across it; `v`: the direction of the eye, stretched to unit
// roughness and normalized.
inline Vec3 beckmann_normal(Vec3 v, double x, double y) {
  const double sine = std::hypot(v.x, v.y);
  const Vec2 along = sine > 0 ? Vec2{v.x / sine, v.y / sine} : Vec2{1, 0};
  return normalized(Vec3{-x * along.x + y * along.y, -x * along.y - y * along.x, 1});
}
inline Vec3 beckmann_visible_normal(Vec3 v, Vec2 u) {
  return beckmann_normal(v, beckmann_visible_slope(v.z, std::hypot(v.x, v.y), u.x), beckmann_visible_slope(1, 0, u.y));
}

}  // namespace gonio::surface
