// The reflection of a rough metal: GGX single scattering, and what scatters between facets more than once.
//   f = F(wi.h) D(h) G2 / (4 wiz woz)  +  F_more (1 - E(wi)) (1 - E(wo)) / (pi (1 - E_mean))
//   F_more = F_mean^2 E_mean / (1 - F_mean (1 - E_mean))
// E is the directional albedo of the lobe for F = 1 (surface/interface_albedo.h), F_mean the cosine-weighted mean of
// the Fresnel factor. Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks", pages 10-15. Reciprocal;
// a mirror of any roughness (F = 1) reflects all light. Sampling picks between visible normals and a cosine-weighted
// direction by reflected power.
#pragma once
#include "surface/hemisphere.h"
#include "surface/interface_albedo.h"
#include "surface/microfacet.h"
#include "surface/polarization.h"
#include "surface/surface.h"

namespace gonio::surface {

class MetalLobe {
 public:
  // `wo` above the horizon; `fresnel_mean` per colour.
  MetalLobe(double alpha, Rgb fresnel_mean, Vec3 wo)
      : ggx_(alpha), alpha_(alpha), wo_(wo), once_(mirror_albedo(wo.z, alpha)) {
    const double all = mirror_albedo_mean(alpha), lost = 1 - all;
    if (lost <= 0) return;
    const auto more = [&](double f) { return f * f * all / (1 - f * lost); };
    more_ = Rgb{more(fresnel_mean.x), more(fresnel_mean.y), more(fresnel_mean.z)} * ((1 - once_) / lost);
    const double diffuse = mean(more_) * lost, direct = mean(fresnel_mean) * once_;
    share_ = diffuse + direct > 0 ? direct / (diffuse + direct) : 1;
  }
  // fresnel(cosine) -> Rgb
  template <class Fresnel>
  Rgb evaluate(const Fresnel& fresnel, Vec3 wi) const {
    const Vec3 h = half_vector(wo_, wi);
    return fresnel(dot(wo_, h)) * ggx_.lobe(wo_, wi, h) + more_ * ((1 - mirror_albedo(wi.z, alpha_)) / pi);
  }
  // Share of evaluate() that met one facet alone, per colour.
  template <class Fresnel>
  Rgb share_of_one_facet(const Fresnel& fresnel, Vec3 wi) const {
    const Vec3 h = half_vector(wo_, wi);
    const Rgb once = fresnel(dot(wo_, h)) * ggx_.lobe(wo_, wi, h), all = evaluate(fresnel, wi);
    return {share_of(once.x, all.x), share_of(once.y, all.y), share_of(once.z, all.z)};
  }
  double pdf(Vec3 wi) const { return share_ * ggx_.pdf(wo_, half_vector(wo_, wi)) + (1 - share_) * cosine_density(wi); }
  template <class Fresnel>
  Sample sample(const Fresnel& fresnel, Vec2 u, double u_lobe) const {
    const Vec3 wi = u_lobe < share_ ? mirrored(wo_, ggx_.visible_normal(wo_, u)) : cosine_direction(u);
    if (wi.z <= 0) return {};
    const double density = pdf(wi);
    if (!(density > 0)) return {};
    return {wi, evaluate(fresnel, wi) * (wi.z / density), density};
  }
  // Reflectance of the part that scatters once: a midpoint rule over visible normals, finer towards the far slopes.
  template <class Fresnel>
  Rgb albedo_once(const Fresnel& fresnel) const {
    constexpr int radii = 24, angles = 8;
    Rgb sum;
    for (int i = 0; i < radii; ++i) {
      const double v = (i + 0.5) / radii, share = 3 * v * v / (radii * angles);
      for (int j = 0; j < angles; ++j) {  // half of the circle: the other is its mirror image
        const Vec3 h = ggx_.visible_normal(wo_, {1 - v * v * v, 0.5 * (j + 0.5) / angles - 0.25});
        const Vec3 wi = mirrored(wo_, h);
        if (wi.z > 0) sum += fresnel(dot(wo_, h)) * (share * ggx_.weight(wo_, wi));
      }
    }
    return sum;
  }
  // Reflectance of the part that scatters more than once.
  Rgb albedo_more() const { return more_ * (1 - mirror_albedo_mean(alpha_)); }

 private:
  Ggx ggx_;
  double alpha_;
  Vec3 wo_;
  double once_, share_ = 1;
  Rgb more_;
};

// A model that is one such lobe: `Optics` says, for a surface's values, `lobe(values, wo)`, `fresnel(values)`, which
// takes a cosine to a colour, and `index(values, band)`, the complex index that polarizes. Light that met several
// facets is unpolarized.
template <class Optics>
class MetalModel : public Model {
 public:
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Optics::lobe(values, wo).evaluate(Optics::fresnel(values), wi) : Rgb{};
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    return wo.z > 0 ? Optics::lobe(values, wo).sample(Optics::fresnel(values), u, u_lobe) : Sample{};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Optics::lobe(values, wo).pdf(wi) : 0;
  }
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    const Rgb once = Optics::lobe(values, wo).share_of_one_facet(Optics::fresnel(values), wi);
    const double cosine = dot(wo, half_vector(wo, wi));
    optics::MuellerRgb result;
    for (int i = 0; i < 3; ++i)
      result[static_cast<std::size_t>(i)] =
          mixed(reflected_by(cosine, Optics::index(values, i)), optics::Mueller::depolarizer(), once[i]);
    return result;
  }
};

}  // namespace gonio::surface
