// Rough interfaces as fields of facets: GGX or Beckmann slopes, with different roughness along two axes. Local frame, z
// the macroscopic normal. u, v: the axes of alpha_u and alpha_v, turned by the azimuth from +x.
//   r = hypot(hu / alpha_u, hv / alpha_v)
//   GGX       D(h) = 1 / (pi alpha_u alpha_v (r^2 + hz^2)^2)                  Walter et al. 2007, equation 33
//   Beckmann  D(h) = exp(-r^2 / hz^2) / (pi alpha_u alpha_v hz^4)             ibid., equation 25
//   s = hypot(alpha_u wu, alpha_v wv),  c = |wz|
// P(w) = c (1 + Lambda(w)) = c / G1(w) is the area that the facets which w sees show to it (Heitz 2014, equation 14):
//   GGX       P = (c + sqrt(c^2 + s^2)) / 2
//   Beckmann  P = c (1 + erf(c / s)) / 2 + s exp(-(c / s)^2) / (2 sqrt(pi))
// Nothing is divided by a cosine: grazing angles stay finite. With P the lobes for a Fresnel factor of one are
//   reflection    D / (4 (ci Po + co Pi - ci co)), heights correlated         Heitz 2014, equation 99
//   transmission  |wi.h| |wo.h| D / (Po Pi (wo.h + eta wi.h)^2)               Walter et al. 2007, equation 21
// with eta the index beyond over that on wo's side; the second holds the factor 1 / eta^2 of radiance.
// Normals are drawn with the density (wo.h) D(h) / P(wo): GGX by Heitz 2018, Beckmann by inversion of the distribution
// of visible slopes (surface/beckmann.h).
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "geom/vector.h"
#include "manifest/model.h"
#include "surface/beckmann.h"
#include "surface/microfacet.h"

namespace gonio::surface {

enum class Slopes { ggx, beckmann };

// Below this an interface is a perfect mirror: its lobe is narrower than any pixel or lamp.
inline constexpr double smooth_alpha = 1e-4;

// Roughness as parameters state it: `alpha` along u, and across it alpha (1 - 0.9 anisotropy).
struct Roughness {
  double alpha = 0, anisotropy = 0, azimuth_rad = 0;
  double across() const { return alpha * (1 - 0.9 * anisotropy); }
  bool smooth() const { return alpha < smooth_alpha; }
};

// Their declaration, in the order of the members.
inline std::vector<manifest::ParameterInfo> roughness_parameters(double preset_alpha) {
  return {{.name = "alpha",
           .unit = "1",
           .preset = preset_alpha,
           .lower = 0,
           .upper = 1,
           .meaning = "roughness: 0 is perfectly smooth; along the tangent where anisotropy is not 0"},
          {.name = "anisotropy",
           .unit = "1",
           .preset = 0,
           .lower = 0,
           .upper = 1,
           .meaning = "how much smoother it is across the tangent: roughness there is alpha (1 - 0.9 anisotropy)"},
          {.name = "azimuth_rad",
           .unit = "rad",
           .preset = 0,
           .lower = -pi,
           .upper = pi,
           .meaning = "turns the tangent about the normal"}};
}

template <Slopes kind>
class Facets {
 public:
  // `inside`: seen from the inner side, where the same azimuth turns the other way.
  explicit Facets(const Roughness& roughness, bool inside = false)
      : alpha_u_(roughness.alpha), alpha_v_(roughness.across()) {
    if (alpha_u_ == alpha_v_ || roughness.azimuth_rad == 0) return;
    cos_ = std::cos(roughness.azimuth_rad);
    sin_ = inside ? -std::sin(roughness.azimuth_rad) : std::sin(roughness.azimuth_rad);
  }

  double density_of_normals(Vec3 h) const {
    if (h.z <= 0) return 0;
    const Vec2 t = turned(h);
    const double a = t.x / alpha_u_, b = t.y / alpha_v_, r2 = a * a + b * b, z2 = h.z * h.z;
    if constexpr (kind == Slopes::ggx) return 1 / (pi * alpha_u_ * alpha_v_ * (r2 + z2) * (r2 + z2));
    return r2 < 700 * z2 ? std::exp(-r2 / z2) / (pi * alpha_u_ * alpha_v_ * z2 * z2) : 0;
  }
  // P(w).
  double area_seen(Vec3 w) const {
    const Vec2 t = turned(w);
    const double a = alpha_u_ * t.x, b = alpha_v_ * t.y, s2 = a * a + b * b, c = std::abs(w.z);
    if constexpr (kind == Slopes::ggx) return (c + std::sqrt(c * c + s2)) / 2;
    return beckmann_area_seen(c, std::sqrt(s2));
  }
  double reflection(Vec3 wo, Vec3 wi, Vec3 h, double seen_o) const {
    return density_of_normals(h) / (4 * (wi.z * seen_o + wo.z * area_seen(wi) - wi.z * wo.z));
  }
  double reflection_pdf(Vec3 h, double seen_o) const { return density_of_normals(h) / (4 * seen_o); }
  // Without |wi.h| |wo.h| / (wo.h + eta wi.h)^2.
  double transmission(Vec3 wi, Vec3 h, double seen_o) const { return density_of_normals(h) / (seen_o * area_seen(wi)); }
  // What a direction counts that was drawn by way of a visible normal, for a Fresnel factor of one: G2 / G1(wo),
  // G1(wi).
  double reflection_weight(Vec3 wo, Vec3 wi, double seen_o) const {
    return wi.z * seen_o / (wi.z * seen_o + wo.z * area_seen(wi) - wi.z * wo.z);
  }
  double transmission_weight(Vec3 wi) const { return std::abs(wi.z) / area_seen(wi); }

  Vec3 visible_normal(Vec3 wo, Vec2 u) const {
    const Vec3 v = stretched(wo);
    return facet_of(kind == Slopes::ggx ? ggx_visible_normal(v, u) : beckmann_visible_normal(v, u));
  }
  // Direction in the frame of u and v where both roughnesses are one, and the facet of a unit normal there.
  Vec3 stretched(Vec3 w) const {
    const Vec2 t = turned(w);
    return normalized(Vec3{alpha_u_ * t.x, alpha_v_ * t.y, w.z});
  }
  Vec3 facet_of(Vec3 unit) const {
    const double a = alpha_u_ * unit.x, b = alpha_v_ * unit.y;
    return normalized(Vec3{cos_ * a - sin_ * b, sin_ * a + cos_ * b, std::max(1e-12, unit.z)});
  }

  // In the frame of u and v.
  Vec3 in_axes(Vec3 w) const {
    const Vec2 t = turned(w);
    return {t.x, t.y, w.z};
  }

 private:
  Vec2 turned(Vec3 w) const { return {cos_ * w.x + sin_ * w.y, cos_ * w.y - sin_ * w.x}; }
  double alpha_u_, alpha_v_, cos_ = 1, sin_ = 0;
};

}  // namespace gonio::surface
