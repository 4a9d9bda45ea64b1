// The interface over a translucent medium: GGX single scattering with exact Fresnel factor, or smooth.
//   E(cosine) = directional reflectance (surface/interface_albedo.h; smooth: F),  T = 1 - E
// What facets send back into the surface counts as transmitted. Rough refraction: a facet h is drawn by visibility from
// wi; the share 1 - F(wi.h) G2 / G1 passes (G2 / G1 is 0 where the mirror direction is below the horizon), whose mean
// over h is T(wi), and goes on along wi refracted at h: the hemispherical transmittance integral of the thesis'
// equation 9, with what shadowed facets reflect added to what they refract.
#pragma once
#include <algorithm>
#include <cmath>

#include "surface/dipole_medium.h"
#include "surface/fresnel.h"
#include "surface/interface_albedo.h"
#include "surface/microfacet.h"
#include "surface/subsurface.h"
#include "surface/surface.h"

namespace gonio::surface {

// Unit `w` above the facet `h`, refracted into a medium of relative index eta >= 1.
inline Vec3 refracted_inwards(Vec3 w, Vec3 h, double eta) {
  const double c = dot(w, h), t = std::sqrt(std::max(0.0, 1 - (1 - c * c) / (eta * eta)));
  return normalized(h * (c / eta - t) - w / eta);
}

class DipoleInterface {
 public:
  DipoleInterface(double eta, double alpha)
      : eta_(eta), alpha_(alpha), f0_((eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1))), ggx_(alpha) {}

  bool smooth() const { return alpha_ < min_alpha; }
  double reflects(double cosine) const {
    return smooth() ? fresnel_dielectric(cosine, eta_) : f0_ > 0 ? dielectric_albedo(cosine, alpha_, f0_) : 0;
  }
  double reflects_mean() const {
    return smooth() ? 1 - InteriorFresnel(eta_).transmits_in : f0_ > 0 ? dielectric_albedo_mean(alpha_, f0_) : 0;
  }
  double lobe(Vec3 wo, Vec3 wi) const {
    if (smooth()) return 0;
    const Vec3 h = half_vector(wo, wi);
    return fresnel_dielectric(dot(wo, h), eta_) * ggx_.lobe(wo, wi, h);
  }
  double lobe_pdf(Vec3 wo, Vec3 wi) const { return smooth() ? 0 : ggx_.pdf(wo, half_vector(wo, wi)); }
  Vec3 facet(Vec3 w, Vec2 u) const { return smooth() ? Vec3{0, 0, 1} : ggx_.visible_normal(w, u); }

  Entrance enter(Vec3 wi, Vec2 u) const {
    const Vec3 h = facet(wi, u), back = mirrored(wi, h);
    const double seen = smooth() ? 1 : back.z > 0 ? ggx_.weight(wi, back) : 0;
    return {1 - fresnel_dielectric(dot(wi, h), eta_) * seen, refracted_inwards(wi, h, eta_)};
  }

  // From within, along `travel` (z > 0). Facets are drawn by visibility and masked on the far side: Walter et al. 2007,
  // section 5.3, with Heitz 2018.
  Entrance leave(Vec3 travel, Vec2 u) const {
    const Vec3 h = facet(travel, u);
    const double c = dot(travel, h), sine2 = eta_ * eta_ * (1 - c * c);
    if (!(c > 0) || sine2 >= 1) return {};
    const double t = std::sqrt(1 - sine2);
    const Vec3 out = normalized(travel * eta_ + h * (t - eta_ * c));
    if (out.z <= 0) return {};
    const double seen = smooth() ? 1 : ggx_.weight(travel, out);
    return {(1 - fresnel_dielectric(t, eta_)) * seen, out};
  }

  // Reflection with probability `share`; otherwise on by way of the medium, its weight times `passes`.
  Sample sample(Vec3 wo, Vec2 u, double u_lobe, double share) const {
    const Vec3 h = facet(wo, u);
    if (u_lobe >= share) {
      const double weight = (1 - reflects(wo.z)) / (1 - share);
      return {refracted_inwards(wo, h, eta_), {weight, weight, weight}, 1 - share, smooth(), true};
    }
    const Vec3 wi = mirrored(wo, h);
    if (wi.z <= 0) return {};
    if (smooth()) {
      const double weight = fresnel_dielectric(wo.z, eta_) / share;
      return {wi, {weight, weight, weight}, share, true};
    }
    const double density = share * lobe_pdf(wo, wi);
    if (!(density > 0)) return {};
    const double weight = lobe(wo, wi) * wi.z / density;
    return {wi, {weight, weight, weight}, density};
  }

 private:
  double eta_, alpha_, f0_;
  Ggx ggx_;
};

}  // namespace gonio::surface
