// GGX microfacets: distribution of normals, height-correlated masking and shadowing, sampling of visible normals.
// Local frame, z the macroscopic normal; `w*` unit vectors with z > 0; isotropic roughness alpha.
//   D(h) = alpha^2 / (pi (alpha^2 hz^2 + hx^2 + hy^2)^2)                  Walter et al. 2007, equation 33
//   S(w) = sqrt(wz^2 + alpha^2 (wx^2 + wy^2)),  G1 = 2 wz / (wz + S)      ibid., equation 34
//   G2   = 2 wiz woz / (woz S(wi) + wiz S(wo)), height-correlated         Heitz 2014, equation 99
//   normals are drawn with density G1(wo) (wo.h) D(h) / woz               Heitz 2018, listing 1
// The reflected lobe is F D G2 / (4 wiz woz). Nothing is divided by a cosine: grazing angles stay finite.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::surface {

// Half vector of two directions above the horizon; the normal itself where they are opposite to the last digit.
inline Vec3 half_vector(Vec3 wo, Vec3 wi) {
  const Vec3 sum = wo + wi;
  const double square = dot(sum, sum);
  return square > 1e-280 ? sum / std::sqrt(square) : Vec3{0, 0, 1};
}

// Cosine of the angle between either of them and their half vector: the same for both to the last bit.
inline double half_cosine(Vec3 wo, Vec3 wi) {
  return norm(wo + wi) / 2;
}

// Normal of unit roughness that `v` sees, a unit direction stretched to that roughness (Heitz 2018, listing 1).
inline Vec3 ggx_visible_normal(Vec3 v, Vec2 u) {
  const double across = std::hypot(v.x, v.y);
  const Vec3 t1 = across > 0 ? Vec3{-v.y / across, v.x / across, 0} : Vec3{1, 0, 0};
  const Vec3 t2 = cross(v, t1);
  const double r = std::sqrt(u.x), phi = 2 * pi * u.y, s = (1 + v.z) / 2;
  const double a = r * std::cos(phi);
  const double b = (1 - s) * std::sqrt(std::max(0.0, 1 - a * a)) + s * r * std::sin(phi);
  return t1 * a + t2 * b + v * std::sqrt(std::max(0.0, 1 - a * a - b * b));
}

template <class T>
class GgxOf {
 public:
  explicit GgxOf(const T& alpha) : alpha_(alpha), alpha2_(alpha * alpha) {}

  T density_of_normals(Vec3 h) const {
    const T q = alpha2_ * h.z * h.z + h.x * h.x + h.y * h.y;
    return h.z > 0 ? alpha2_ / (pi * q * q) : T(0);
  }
  // D G2 / (4 wiz woz): the BRDF for a Fresnel factor of one.
  T lobe(Vec3 wo, Vec3 wi, Vec3 h) const {
    return density_of_normals(h) / (2 * (wo.z * stretch(wi) + wi.z * stretch(wo)));
  }
  // Density of wi per steradian when normals are drawn by visibility: G1(wo) D(h) / (4 woz).
  double pdf(Vec3 wo, Vec3 h) const { return density_of_normals(h) / (2 * (wo.z + stretch(wo))); }
  // lobe * wiz / pdf = G2 / G1(wo), in [0, 1].
  double weight(Vec3 wo, Vec3 wi) const {
    const double so = stretch(wo);
    return wi.z * (wo.z + so) / (wo.z * stretch(wi) + wi.z * so);
  }
  Vec3 visible_normal(Vec3 wo, Vec2 u) const {
    const Vec3 n = ggx_visible_normal(normalized(Vec3{alpha_ * wo.x, alpha_ * wo.y, wo.z}), u);
    return normalized(Vec3{alpha_ * n.x, alpha_ * n.y, std::max(1e-12, n.z)});
  }

 private:
  T stretch(Vec3 w) const {
    using std::sqrt;
    return sqrt(w.z * w.z + alpha2_ * (w.x * w.x + w.y * w.y));
  }
  T alpha_, alpha2_;
};
using Ggx = GgxOf<double>;

inline Vec3 mirrored(Vec3 wo, Vec3 h) {
  return h * (2 * dot(wo, h)) - wo;
}

}  // namespace gonio::surface
