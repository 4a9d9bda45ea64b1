// The reflection of a metal: what one facet reflects (surface/slopes.h), and what meets several facets.
//   f = F(wi.h) D(h) G2 / (4 wiz woz)  +  F_more L(wi) L(wo) / (pi L_mean)
//   F_more = F_mean^2 (1 - L_mean) / (1 - F_mean L_mean)
// L(w) is what one facet fails to return of a mirror's light, L_mean its cosine-weighted mean
// (surface/interface_loss.h), F_mean the cosine-weighted mean of the Fresnel factor. Kulla & Conty 2017, "Revisiting
// Physically Based Shading at Imageworks", pages 10-15. Reciprocal; a mirror of any roughness (F = 1) reflects all
// light. Sampling picks between visible normals and a cosine-weighted direction by reflected power. Smooth below
// alpha = 1e-4: then the lobe is a delta of the weight F(woz).
#pragma once
#include "surface/facet_slopes.h"
#include "surface/hemisphere.h"
#include "surface/interface_loss.h"
#include "surface/polarization.h"
#include "surface/slopes_grid.h"
#include "surface/surface.h"

namespace gonio::surface {

template <Slopes kind>
class MetalLobe {
 public:
  // `wo` above the horizon; `fresnel_mean` per band; not smooth. `inside`: Facets.
  MetalLobe(const Roughness& roughness, bool inside, Rgb fresnel_mean, Vec3 wo)
      : facets_(roughness, inside),
        isotropic_(roughness.anisotropy == 0),
        wo_(wo),
        seen_(facets_.area_seen(wo)),
        loss_(InterfaceLoss::mirror(kind, roughness)),
        lost_(loss_.towards(facets_.in_axes(wo))) {
    const double mean_lost = loss_.mean();
    if (!(mean_lost > 0)) return;
    const auto more = [&](double f) { return f * f * (1 - mean_lost) / (1 - f * mean_lost) * lost_; };
    more_ = {more(fresnel_mean.x), more(fresnel_mean.y), more(fresnel_mean.z)};
    const double diffuse = mean(more_), direct = mean(fresnel_mean) * (1 - lost_);
    share_ = diffuse + direct > 0 ? direct / (diffuse + direct) : 1;
  }
  // fresnel(cosine) -> Rgb
  template <class Fresnel>
  Rgb evaluate(const Fresnel& fresnel, Vec3 wi) const {
    return once(fresnel, wi) + more(wi);
  }
  // Share of evaluate() that met one facet alone, per band.
  template <class Fresnel>
  Rgb share_of_one_facet(const Fresnel& fresnel, Vec3 wi) const {
    const Rgb single = once(fresnel, wi), all = single + more(wi);
    return {share_of(single.x, all.x), share_of(single.y, all.y), share_of(single.z, all.z)};
  }
  double pdf(Vec3 wi) const {
    return share_ * facets_.reflection_pdf(half_vector(wo_, wi), seen_) + (1 - share_) * cosine_density(wi);
  }
  template <class Fresnel>
  Sample sample(const Fresnel& fresnel, Vec2 u, double u_lobe) const {
    const Vec3 wi = u_lobe < share_ ? mirrored(wo_, facets_.visible_normal(wo_, u)) : cosine_direction(u);
    if (wi.z <= 0) return {};
    const double density = pdf(wi);
    if (!(density > 0)) return {};
    return {wi, evaluate(fresnel, wi) * (wi.z / density), density};
  }
  // The mean Fresnel factor of the light that one facet returns, by quadrature over visible normals, and the rest.
  template <class Fresnel>
  Rgb albedo(const Fresnel& fresnel) const {
    static const SlopesGrid half(kind, 24, 8, true), whole(kind, 24, 16, false);
    Rgb sum;
    double all = 0;
    (isotropic_ ? half : whole).over(facets_, wo_, [&](Vec3 h, double share) {
      const Vec3 wi = mirrored(wo_, h);
      if (wi.z <= 0) return;
      const double weight = share * facets_.reflection_weight(wo_, wi, seen_);
      sum += fresnel(dot(wo_, h)) * weight;
      all += weight;
    });
    return more_ + (all > 0 ? sum * ((1 - lost_) / all) : Rgb{});
  }

 private:
  template <class Fresnel>
  Rgb once(const Fresnel& fresnel, Vec3 wi) const {
    return fresnel(half_cosine(wo_, wi)) * facets_.reflection(wo_, wi, half_vector(wo_, wi), seen_);
  }
  Rgb more(Vec3 wi) const {
    return loss_.mean() > 0 ? more_ * (loss_.towards(facets_.in_axes(wi)) / (pi * loss_.mean())) : Rgb{};
  }

  Facets<kind> facets_;
  bool isotropic_;
  Vec3 wo_;
  double seen_;
  InterfaceLoss loss_;
  double lost_;
  double share_ = 1;
  Rgb more_;  // reflectance of what scatters more than once
};

// A model that is one such lobe. `Optics` says, for a surface's values: `roughness(values)`, `fresnel(values)`, which
// takes a cosine to a reflectance per band, its `fresnel_mean(values)`, and `index(values, band)`, the complex index
// that polarizes. With slopes: `colours` numbers per band, then alpha, anisotropy and azimuth; Fresnel(values, band),
// which takes a cosine to a reflectance and has its `mean`, by those. Light that met several facets is unpolarized.
template <Slopes kind, class Optics>
class MetalModel : public Model {
 public:
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0 || Optics::roughness(values).smooth()) return {};
    return lobe(values, wo).evaluate(Optics::fresnel(values), wi);
  }
  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    constexpr std::size_t first = Optics::colours, all = first + 3;
    std::fill_n(slopes.begin(), all, Rgb{});
    if (wo.z <= 0 || wi.z <= 0 || Optics::roughness(values).smooth()) return {};
    using T = Dual<all>;
    const T azimuth = T::unknown(values.scalar(first + 2), first + 2);
    const MetalLobeSlopes<kind, all> lobe(
        directed(T::unknown(values.scalar(first), first), T::unknown(values.scalar(first + 1), first + 1),
                 values.inside ? -azimuth : azimuth),
        wo, wi, half_vector(wo, wi));
    const double cosine = half_cosine(wo, wi);
    Rgb value;
    for (int c = 0; c < 3; ++c) {
      const typename Optics::template Fresnel<T> fresnel(values, c);
      put_band(lobe.evaluate(fresnel(cosine), fresnel.mean()), c, value, slopes);
    }
    return value;
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const auto fresnel = Optics::fresnel(values);
    if (Optics::roughness(values).smooth())
      return {.wi = {-wo.x, -wo.y, wo.z}, .weight = fresnel(wo.z), .pdf = 1, .delta = true};
    return lobe(values, wo).sample(fresnel, u, u_lobe);
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0 || Optics::roughness(values).smooth()) return 0;
    return lobe(values, wo).pdf(wi);
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    const auto fresnel = Optics::fresnel(values);
    return Optics::roughness(values).smooth() ? fresnel(wo.z) : lobe(values, wo).albedo(fresnel);
  }
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    const Rgb once = Optics::roughness(values).smooth()
                         ? Rgb{1, 1, 1}
                         : lobe(values, wo).share_of_one_facet(Optics::fresnel(values), wi);
    const double cosine = dot(wo, half_vector(wo, wi));
    optics::MuellerRgb result;
    for (int i = 0; i < 3; ++i)
      result[static_cast<std::size_t>(i)] =
          mixed(reflected_by(cosine, Optics::index(values, i)), optics::Mueller::depolarizer(), once[i]);
    return result;
  }

 private:
  static MetalLobe<kind> lobe(const Values& values, Vec3 wo) {
    return {Optics::roughness(values), values.inside, Optics::fresnel_mean(values), wo};
  }
};

}  // namespace gonio::surface
