// The clear interface over another material (varnish, glaze, binder): what it reflects at its outside and lets through.
//   E(w)  share that one facet reflects, from surface/interface_albedo.h; exact Fresnel where it is smooth, and between
//         the two below alpha = 0.02
//   T(w) = 1 - E(w) goes through: light that meets several facets is taken as transmitted, as most of it is
// Seen from inside, at the refracted direction w', as much goes through (Helmholtz), nothing beyond the critical angle:
// diffuse light inside is reflected by 1 - (1 - E_mean) / eta^2, whatever the roughness.
#pragma once
#include <algorithm>
#include <cmath>

#include "surface/fresnel.h"
#include "surface/hemisphere.h"
#include "surface/interface_albedo.h"
#include "surface/microfacet.h"
#include "surface/slopes.h"

namespace gonio::surface {

inline constexpr double max_coat_eta = 2.6;  // f0 = 0.198, within the tables

// `T`: double, or a number with slopes (geom/dual.h) for what is reflected and passed from outside.
template <class T>
class CoatInterfaceOf {
 public:
  CoatInterfaceOf(const T& eta, const T& alpha)
      : eta_(eta), f0_((eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1))), alpha_(alpha) {}

  T eta() const { return eta_; }
  bool smooth() const { return alpha_ < smooth_alpha; }
  T reflects(double cosine) const {
    if (eta_ == 1.0) return T(0);
    if (alpha_ >= min_alpha) return dielectric_albedo(cosine, alpha_, f0_);
    return toward_smooth(fresnel_dielectric(cosine, eta_),
                         [&] { return dielectric_albedo(cosine, T(min_alpha), f0_); });
  }
  T reflects_mean() const {
    if (eta_ == 1.0) return T(0);
    if (alpha_ >= min_alpha) return dielectric_albedo_mean(alpha_, f0_);
    return toward_smooth(fresnel_dielectric_mean(eta_), [&] { return dielectric_albedo_mean(T(min_alpha), f0_); });
  }
  T reflects_mean_inside() const { return 1 - (1 - reflects_mean()) / (eta_ * eta_); }
  T passes(double cosine) const { return 1 - reflects(cosine); }
  T passes_from_inside(double cosine) const {
    const double out2 = 1 - eta_ * eta_ * (1 - cosine * cosine);
    return out2 > 0 ? passes(std::sqrt(out2)) : 0;
  }

  Vec3 inwards(Vec3 w) const {
    if (eta_ == 1) return w;
    return Vec3{w.x, w.y, std::sqrt((eta_ - 1) * (eta_ + 1) + w.z * w.z)} / eta_;
  }
  // The zero vector where there is total reflection.
  Vec3 outwards(Vec3 w) const {
    const double out2 = 1 - eta_ * eta_ * (1 - w.z * w.z);
    return out2 > 0 ? Vec3{w.x * eta_, w.y * eta_, std::sqrt(out2)} : Vec3{};
  }

  // The lobe of a rough interface.
  T gloss(Vec3 wo, Vec3 wi) const {
    if (smooth() || eta_ == 1.0) return T(0);
    const Vec3 h = half_vector(wo, wi);
    return fresnel_dielectric(half_cosine(wo, wi), eta_) * GgxOf<T>(alpha_).lobe(wo, wi, h);
  }
  double gloss_pdf(Vec3 wo, Vec3 wi) const { return smooth() ? 0 : Ggx(alpha_).pdf(wo, half_vector(wo, wi)); }
  // Of a smooth interface: is wi where it mirrors wo, and so where its delta goes?
  bool mirrors(Vec3 wo, Vec3 wi) const { return smooth() && norm(wi - Vec3{-wo.x, -wo.y, wo.z}) < 1e-9; }
  // Smooth: the mirrored direction.
  Vec3 gloss_direction(Vec3 wo, Vec2 u) const {
    return smooth() ? Vec3{-wo.x, -wo.y, wo.z} : mirrored(wo, Ggx(alpha_).visible_normal(wo, u));
  }

 private:
  template <class Rough>
  T toward_smooth(const T& smooth_value, const Rough& rough_value) const {
    if (smooth()) return smooth_value;
    return smooth_value + (rough_value() - smooth_value) * (alpha_ / min_alpha);
  }
  T eta_, f0_, alpha_;
};
using CoatInterface = CoatInterfaceOf<double>;

}  // namespace gonio::surface
