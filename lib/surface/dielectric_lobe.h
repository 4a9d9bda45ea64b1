// A rough interface between two clear media: what one facet reflects and transmits (surface/slopes.h), with the exact
// Fresnel factor, and what meets more than one facet. Light of the second kind has forgotten where it came from and
// leaves as from a matte sheet: with L(w) the share that single scattering loses on w's side, L_mean its
// cosine-weighted mean, index n (surface/interface_loss.h), and the sides 1 (wo's) and 2,
//   reflected    R L1(wo) L1(wi) / (pi L1_mean),                R = n1^2 L1_mean / (n1^2 L1_mean + n2^2 L2_mean)
//   transmitted  (1 - R) L1(wo) L2(wi) / (pi L2_mean eta^2),    eta = n2 / n1
// Kulla & Conty 2017 with the sides shared by etendue n^2 L_mean. That makes f(wo, wi) / n_o^2 = f(wi, wo) / n_i^2, and
// returns all light. The sheet is diffuse also where eta is near one and real facets would let light go on straight:
// there it errs, by at most L. A band whose eta is one passes unchanged.
//
// Where eta differs between bands directions are drawn for the band `hero`, and pdf() is of that band; evaluate() is
// right for each band. Deltas go in the hero's direction and carry, in transmission, only bands of the same eta.
#pragma once
#include "surface/fresnel.h"
#include "surface/hemisphere.h"
#include "surface/interface_loss.h"
#include "surface/refraction.h"
#include "surface/slopes.h"
#include "surface/surface.h"

namespace gonio::surface {

inline double band(Rgb v, int i) {
  return i == 0 ? v.x : i == 1 ? v.y : v.z;
}
// f per band, once where all bands are alike.
template <class F>
Rgb per_band(Rgb eta, const F& f) {
  const double first = f(eta.x);
  if (eta.x == eta.y && eta.y == eta.z) return {first, first, first};
  return {first, f(eta.y), f(eta.z)};
}

// Smooth: one mirrored and one refracted direction.
class SmoothInterface {
 public:
  SmoothInterface(Rgb eta, int hero, Vec3 wo) : eta_(eta), hero_(band(eta, hero)), wo_(wo) {
    fresnel_ = per_band(eta, [&](double e) { return fresnel_dielectric(wo.z, e); });
    mirrors_ = fresnel_dielectric(wo.z, hero_);
  }
  Sample sample(double u_lobe) const {
    if (u_lobe < mirrors_)
      return {.wi = {-wo_.x, -wo_.y, wo_.z}, .weight = fresnel_ / mirrors_, .pdf = mirrors_, .delta = true};
    const Vec3 wi = matched(hero_) ? -wo_ : refracted(wo_, {0, 0, 1}, hero_);
    if (!(wi.z < 0)) return {};
    const double scale = 1 / ((1 - mirrors_) * hero_ * hero_);
    const auto passed = [&](double eta, double fresnel) { return eta == hero_ ? (1 - fresnel) * scale : 0; };
    return {.wi = wi,
            .weight = {passed(eta_.x, fresnel_.x), passed(eta_.y, fresnel_.y), passed(eta_.z, fresnel_.z)},
            .pdf = 1 - mirrors_,
            .delta = true};
  }

 private:
  Rgb eta_;
  double hero_;
  Vec3 wo_;
  Rgb fresnel_;
  double mirrors_;
};

template <Slopes kind>
class DielectricLobe {
 public:
  DielectricLobe(const Roughness& roughness, bool inside, Rgb eta, int hero, Vec3 wo)
      : roughness_(roughness),
        facets_(roughness, inside),
        eta_(eta),
        hero_(band(eta, hero)),
        wo_(wo),
        seen_(facets_.area_seen(wo)),
        sheet_(roughness, hero_, facets_.in_axes(wo)) {}

  Rgb evaluate(Vec3 wi) const {
    if (wi.z > 0) {
      const Vec3 h = half_vector(wo_, wi);
      const double facet = facets_.reflection(wo_, wi, h, seen_), cosine = half_cosine(wo_, wi);
      return per_band(eta_, [&](double eta) {
        if (matched(eta)) return 0.0;
        return facet * fresnel_dielectric(cosine, eta) + sheet(eta).reflected(facets_.in_axes(wi));
      });
    }
    if (wi.z >= 0) return {};
    return per_band(eta_, [&](double eta) {
      if (matched(eta)) return 0.0;
      return transmitted_once(wi, eta) + sheet(eta).transmitted(facets_.in_axes(wi));
    });
  }

  // Share of evaluate() that met one facet alone, per band.
  Rgb share_of_one_facet(Vec3 wi) const {
    const bool through = wi.z < 0;
    const double facet = through ? 0 : facets_.reflection(wo_, wi, half_vector(wo_, wi), seen_);
    const Vec3 there = facets_.in_axes(wi);
    return per_band(eta_, [&](double eta) {
      if (matched(eta)) return 1.0;
      const double once = through ? transmitted_once(wi, eta) : facet * fresnel_dielectric(half_cosine(wo_, wi), eta);
      const double more = through ? sheet(eta).transmitted(there) : sheet(eta).reflected(there);
      return once + more > 0 ? once / (once + more) : 0;
    });
  }

  double pdf(Vec3 wi) const {
    if (wi.z == 0 || matched(hero_)) return 0;
    const double diffuse = sheet_.lost * (wi.z > 0 ? sheet_.back : 1 - sheet_.back) * std::abs(wi.z) / pi;
    if (wi.z > 0) {
      const Vec3 h = half_vector(wo_, wi);
      return diffuse + (1 - sheet_.lost) * fresnel_dielectric(dot(wo_, h), hero_) * facets_.reflection_pdf(h, seen_);
    }
    const Vec3 h = refracting_normal(wo_, wi, hero_);
    if (h.z <= 0) return diffuse;
    const double o = dot(wo_, h), i = dot(wi, h), across = o + hero_ * i;
    const double density = facets_.density_of_normals(h) * o / seen_ * hero_ * hero_ * -i / (across * across);
    return diffuse + (1 - sheet_.lost) * (1 - fresnel_dielectric(o, hero_)) * density;
  }

  Sample sample(Vec2 u, double u_lobe) const {
    if (matched(hero_)) return unchanged();
    const Vec3 wi = direction(u, u_lobe);
    if (wi.z == 0) return {};
    const double density = pdf(wi);
    if (!(density > 0)) return {};
    return {wi, evaluate(wi) * (std::abs(wi.z) / density), density};
  }

 private:
  // The part that scatters more than once.
  struct Sheet {
    InterfaceLoss here, beyond;
    double eta, lost, back;  // back: share that returns to wo's side
    Sheet(const Roughness& roughness, double relative, Vec3 wo)
        : here(InterfaceLoss::of(kind, roughness, relative)),
          beyond(InterfaceLoss::of(kind, roughness, 1 / relative)),
          eta(relative),
          lost(here.towards(wo)),
          back(here.mean() / (here.mean() + eta * eta * beyond.mean())) {
      if (!(here.mean() > 0 && beyond.mean() > 0)) lost = back = 0;
    }
    // For directions in the facets' axes.
    double reflected(Vec3 wi) const { return lost > 0 ? back * lost * here.towards(wi) / (pi * here.mean()) : 0; }
    double transmitted(Vec3 wi) const {
      return lost > 0 ? (1 - back) * lost * beyond.towards(wi) / (pi * beyond.mean() * eta * eta) : 0;
    }
  };
  Sheet sheet(double eta) const { return eta == hero_ ? sheet_ : Sheet(roughness_, eta, facets_.in_axes(wo_)); }

  double transmitted_once(Vec3 wi, double eta) const {
    const Vec3 h = refracting_normal(wo_, wi, eta);
    if (h.z <= 0) return 0;
    const double o = dot(wo_, h), i = dot(wi, h), across = o + eta * i;
    return facets_.transmission(wi, h, seen_) * (1 - fresnel_dielectric(o, eta)) * o * -i / (across * across);
  }

  // The zero vector where a facet sends light into the surface's other facets.
  Vec3 direction(Vec2 u, double u_lobe) const {
    if (u_lobe < sheet_.lost) {
      const Vec3 w = cosine_direction(u);
      return u_lobe < sheet_.lost * sheet_.back ? w : Vec3{w.x, w.y, -w.z};
    }
    const Vec3 h = facets_.visible_normal(wo_, u);
    const double choice = (u_lobe - sheet_.lost) / (1 - sheet_.lost);
    if (choice < fresnel_dielectric(dot(wo_, h), hero_)) {
      const Vec3 wi = mirrored(wo_, h);
      return wi.z > 0 ? wi : Vec3{};
    }
    const Vec3 wi = refracted(wo_, h, hero_);
    return wi.z < 0 ? wi : Vec3{};
  }

  // What goes straight on, in the bands that pass unchanged.
  Sample unchanged() const {
    const auto passed = [](double eta) { return matched(eta) ? 1.0 : 0.0; };
    return {.wi = -wo_, .weight = {passed(eta_.x), passed(eta_.y), passed(eta_.z)}, .pdf = 1, .delta = true};
  }

  Roughness roughness_;
  Facets<kind> facets_;
  Rgb eta_;
  double hero_;
  Vec3 wo_;
  double seen_;
  Sheet sheet_;
};

}  // namespace gonio::surface
