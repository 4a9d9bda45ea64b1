// The lobe of surface/slopes.h by numbers with slopes (geom/dual.h), without axes: an astigmatism (a0, a45) stretches
// the roughness by the matrix A = [[a0, a45], [a45, -a0]], and with r = hypot(a0, a45)
//   alpha^2 exp(2 A) = alpha^2 (cosh(2 r) I + sinh(2 r) / r A)
// is the form behind alpha_u^2, alpha_v^2 and their axes:
//   r_h^2 = h' exp(-2 A) h / alpha^2,   s^2 = w' exp(2 A) w alpha^2,   alpha_u alpha_v = alpha^2
// which are smooth where the surface has no direction (r = 0), unlike an azimuth. Roughness along u is at most 1:
// alpha <= exp(-r).
#pragma once
#include <cmath>

#include "geom/dual.h"
#include "surface/beckmann.h"
#include "surface/interface_loss.h"
#include "surface/slopes.h"

namespace gonio::surface {

template <std::size_t N>
struct DirectedRoughness {
  Dual<N> alpha, a0, a45;  // alpha: geometric mean of both axes
  bool none() const { return a0.v == 0 && a45.v == 0; }
};

// From `alpha` along the tangent turned by the azimuth, and `anisotropy`: as struct Roughness.
template <std::size_t N>
DirectedRoughness<N> directed(const Dual<N>& alpha, const Dual<N>& anisotropy, const Dual<N>& azimuth_rad) {
  const Dual<N> own = -0.5 * log(1 - 0.9 * anisotropy), twice = 2 * azimuth_rad;
  return {alpha * exp(-own), own * cos(twice), own * sin(twice)};
}

template <Slopes kind, std::size_t N>
class FacetForm {
 public:
  using T = Dual<N>;
  explicit FacetForm(const DirectedRoughness<N>& roughness) : a0_(roughness.a0), a45_(roughness.a45) {
    const T square = a0_ * a0_ + a45_ * a45_;
    const double r = std::sqrt(square.v);
    // cosh(2 sqrt x) and sinh(2 sqrt x) / sqrt x, with their slopes by x.
    if (r > 1e-4) {
      const double c = std::cosh(2 * r), s = std::sinh(2 * r) / r;
      even_ = square.chain(c, s);
      odd_ = square.chain(s, (2 * c - s) / (2 * square.v));
    } else {
      even_ = square.chain(1 + 2 * square.v, 2);
      odd_ = square.chain(2 + 4 * square.v / 3, 4 / 3.0);
    }
    alpha2_ = roughness.alpha * roughness.alpha;
    if (alpha2_.v * std::exp(2 * r) > 1) alpha2_ = exp(-2 * sqrt(square));
  }

  template <class V>
  T density_of_normals(const V& h) const {
    if (value_of(h.z) <= 0) return T(0);
    const T r2 = (even_ * (h.x * h.x + h.y * h.y) - odd_ * along(h)) / alpha2_;
    const auto z2 = h.z * h.z;
    if constexpr (kind == Slopes::ggx) return 1 / (pi * alpha2_ * ((r2 + z2) * (r2 + z2)));
    return r2.v < 700 * value_of(z2) ? exp(-r2 / z2) / (pi * alpha2_ * (z2 * z2)) : T(0);
  }
  template <class V>
  T area_seen(const V& w) const {
    const T s2 = alpha2_ * (even_ * (w.x * w.x + w.y * w.y) + odd_ * along(w));
    if constexpr (kind == Slopes::ggx) return (w.z + sqrt(w.z * w.z + s2)) / 2;
    return beckmann_area_seen(w.z, sqrt(s2));
  }
  // V: Vec3, or Vec3Of<T> where directions depend on unknowns.
  template <class V>
  T reflection(const V& wo, const V& wi, const V& h) const {
    return density_of_normals(h) / (4 * (wi.z * area_seen(wo) + wo.z * area_seen(wi) - wi.z * wo.z));
  }

  // What a direction sees as an isotropic roughness: surface/gloss_lobes.h.
  T roughness_towards(Vec3 w) const { return sqrt(alpha2_ * (even_ + odd_ * along(w))); }
  T roughness_from_above() const { return sqrt(alpha2_ * even_); }

 private:
  template <class V>
  T along(const V& w) const {
    return a0_ * (w.x * w.x - w.y * w.y) + a45_ * (2 * (w.x * w.y));
  }
  T a0_, a45_, even_, odd_, alpha2_;
};

// What one facet of such a mirror fails to return, towards a direction and in the mean.
template <Slopes kind, std::size_t N>
class MirrorLoss {
 public:
  using T = Dual<N>;
  explicit MirrorLoss(const DirectedRoughness<N>& roughness) : alpha_(roughness.alpha), anisotropy_(0), azimuth_(0) {
    if (!roughness.none()) {
      const T r = hypot(roughness.a0, roughness.a45);
      alpha_ = roughness.alpha * exp(r);
      anisotropy_ = (1 - exp(-2 * r)) / 0.9;
      azimuth_ = 0.5 * atan2(roughness.a45, roughness.a0);
    }
    if (alpha_ > 1.0) alpha_ = T(1);
    table_ = InterfaceLossSlopes::of(kind, alpha_.v, anisotropy_.v);
  }
  T towards(Vec3 w) const {
    if (anisotropy_.v == 0) return chained(table_.towards(w), T(0));
    const double across2 = w.x * w.x + w.y * w.y;
    const T x = cos(azimuth_) * w.x + sin(azimuth_) * w.y;
    const T cosine = across2 > 0 ? abs(x) / std::sqrt(across2) : T(1);
    const double y = std::sqrt(std::max(0.0, across2 - x.v * x.v));
    return chained(table_.towards({x.v, y, w.z}), cosine);
  }
  T mean() const { return chained(table_.mean(), T(0)); }

 private:
  T chained(const LossSlopes& at, const T& cosine) const {
    T r(at.value);
    for (std::size_t i = 0; i < N; ++i)
      r.d[i] = at.by_alpha * alpha_.d[i] + at.by_anisotropy * anisotropy_.d[i] + at.by_cosine * cosine.d[i];
    return r;
  }
  T alpha_, anisotropy_, azimuth_;
  InterfaceLossSlopes table_;
};

// surface/metal_lobe.h for one band: everything but the Fresnel factor is shared by the bands.
template <Slopes kind, std::size_t N>
class MetalLobeSlopes {
 public:
  using T = Dual<N>;
  MetalLobeSlopes(const DirectedRoughness<N>& roughness, Vec3 wo, Vec3 wi, Vec3 h) {
    facet_ = FacetForm<kind, N>(roughness).reflection(wo, wi, h);
    const MirrorLoss<kind, N> loss(roughness);
    mean_ = loss.mean();
    if (mean_ > 0.0) often_ = loss.towards(wo) * loss.towards(wi) * (1 - mean_) / (pi * mean_);
  }
  T evaluate(const T& fresnel, const T& fresnel_mean) const {
    return fresnel * facet_ + fresnel_mean * fresnel_mean / (1 - fresnel_mean * mean_) * often_;
  }

 private:
  T facet_, mean_, often_;
};

// Band c of a result into value and slopes, in the order of the unknowns.
template <std::size_t N>
void put_band(const Dual<N>& f, int c, Rgb& value, std::span<Rgb> slopes) {
  const auto at = [c](Vec3& v) -> double& { return c == 0 ? v.x : c == 1 ? v.y : v.z; };
  at(value) = f.v;
  for (std::size_t i = 0; i < N; ++i) at(slopes[i]) = f.d[i];
}

}  // namespace gonio::surface
