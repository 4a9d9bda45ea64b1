// Residue on an engineered relief: lumps of its own material, such as burrs, flash or dust, that cover a share of it
// and reflect by slopes of their own about the sample's normal, in no direction that the relief prefers.
//   f = (1 - share) f_relief + share (F + (1 - F)^2 rho_d / pi) D(h) G2 / (4 (wi.n) (wo.n))
// GGX of the residue's roughness (surface/microfacet.h), material: surface/ridge_facets.h. A mixture of two surfaces
// that are reciprocal and return no more than they receive. What lumps hide of the relief, and what they throw back
// onto it, is left out. At share 0 the relief's values stand, to the last bit.
#pragma once
#include <vector>

#include "surface/microfacet.h"
#include "surface/ridge_facets.h"

namespace gonio::surface {

class Residue {
 public:
  // `first`: place of residue_share among the model's parameters; residue_alpha follows.
  Residue(const Values& values, std::size_t first) : share_(values.scalar(first)), lumps_(values.scalar(first + 1)) {}

  bool none() const { return !(share_ > 0); }
  double share() const { return share_; }
  Rgb over(Rgb relief, const FacetMaterial& material, Vec3 wo, Vec3 wi) const {
    if (none()) return relief;
    return relief * (1 - share_) +
           material.reflects(half_cosine(wo, wi)) * (share_ * lumps_.lobe(wo, wi, half_vector(wo, wi)));
  }
  double pdf(double relief, Vec3 wo, Vec3 wi) const {
    return none() ? relief : (1 - share_) * relief + share_ * lumps_.pdf(wo, half_vector(wo, wi));
  }
  Rgb albedo(Rgb relief, const FacetMaterial& material, Vec3 wo) const {
    if (none()) return relief;
    constexpr int count = 512;
    Rgb sum;
    for (int i = 0; i < count; ++i) {  // Roberts 2018, two dimensions
      const double a = 0.5 + i * 0.7548776662466927, b = 0.5 + i * 0.5698402909980532;
      const Vec3 wi = mirrored(wo, lumps_.visible_normal(wo, {a - std::floor(a), b - std::floor(b)}));
      if (wi.z > 0) sum += material.reflects(half_cosine(wo, wi)) * lumps_.weight(wo, wi);
    }
    return relief * (1 - share_) + sum * (share_ / count);
  }
  // The lumps' direction, or what `relief` draws with the random number that is left.
  template <class Relief>
  Vec3 direction(Vec3 wo, Vec2 u, double u_lobe, const Relief& relief) const {
    if (none()) return relief(u_lobe);
    return u_lobe < share_ ? mirrored(wo, lumps_.visible_normal(wo, u)) : relief((u_lobe - share_) / (1 - share_));
  }

 private:
  double share_;
  Ggx lumps_;
};

// Its declaration, after a model's own parameters.
inline std::vector<manifest::ParameterInfo> with_residue(std::vector<manifest::ParameterInfo> own) {
  own.push_back({.name = "residue_share",
                 .unit = "1",
                 .preset = 0,
                 .lower = 0,
                 .upper = 1,
                 .meaning = "share that lumps of residue cover, such as burrs or dust"});
  own.push_back({.name = "residue_alpha",
                 .unit = "1",
                 .preset = 0.5,
                 .lower = 0.1,
                 .upper = 1,
                 .meaning = "GGX roughness of the residue; without effect where its share is 0"});
  return own;
}

}  // namespace gonio::surface
