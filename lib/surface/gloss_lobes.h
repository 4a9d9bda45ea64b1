// Facets of a gloss that one GGX lobe does not describe: a direction, and a second population of facets.
//   D G2 / (4 wiz woz) = (1 - s) lobe(alpha, wi, wo) + s lobe(alpha_2, wi, wo),    s the second share
// Each lobe is that of surface/slopes.h with the Fresnel factor taken out; a mixture of reciprocal lobes that lose no
// energy is one itself. The direction is stated like an astigmatism (Thibos, Wheeler & Horner 1997), free of the jump
// that an azimuth has where the surface is isotropic:
//   log alpha(axis 0) - log alpha(axis 90) = 2 a0,  log alpha(axis 45) - log alpha(axis 135) = 2 a45
// so that alpha_u = alpha exp(r), alpha_v = alpha exp(-r), r = hypot(a0, a45), u at atan2(a45, a0) / 2 from the
// tangent. And alpha_u is at most 1, where tables of energy end.
// What a direction w sees of an anisotropic interface is taken as that of an isotropic one of the roughness
//   alpha(w)^2 = wz^2 (alpha_u^2 + alpha_v^2) / 2 + (alpha_u wu)^2 + (alpha_v wv)^2
// the mean of both axes from above, and the roughness along w (Heitz 2014, equation 80) towards the horizon.
#pragma once
#include <array>
#include <cmath>

#include "surface/retro_lobe.h"
#include "surface/slopes.h"

namespace gonio::surface {

inline constexpr double max_astigmatism = 0.8;

struct Astigmatism {
  double a0 = 0, a45 = 0;
  bool none() const { return a0 == 0 && a45 == 0; }
};

inline Roughness stretched(double alpha, Astigmatism a) {
  if (a.none()) return {alpha, 0, 0};
  const double r = std::hypot(a.a0, a.a45);
  return {std::min(1.0, alpha * std::exp(r)), (1 - std::exp(-2 * r)) / 0.9, 0.5 * std::atan2(a.a45, a.a0)};
}

// alpha(w) above; `w` of any direction: from above where it is the normal.
inline double roughness_towards(double alpha, Astigmatism a, Vec3 w) {
  if (a.none()) return alpha;
  const double r = std::hypot(a.a0, a.a45), u = std::min(1.0, alpha * std::exp(r)), v = u * std::exp(-2 * r);
  // (wu^2 - wv^2) by the double angles of w.
  const double difference = ((w.x * w.x - w.y * w.y) * a.a0 + 2 * w.x * w.y * a.a45) / r;
  return std::sqrt(0.5 * (u * u + v * v) + 0.5 * (u * u - v * v) * difference);
}

class GlossLobes {
 public:
  GlossLobes(double alpha, double second_share, double second_alpha, Astigmatism a, Vec3 wo)
      : facets_{Facets<Slopes::ggx>(stretched(alpha, a)), Facets<Slopes::ggx>(stretched(second_alpha, a))},
        share_(second_share),
        seen_{facets_[0].area_seen(wo), facets_[1].area_seen(wo)},
        wo_(wo) {}

  double lobe(Vec3 wi, Vec3 h) const {
    const double first = facets_[0].reflection(wo_, wi, h, seen_[0]);
    return share_ > 0 ? (1 - share_) * first + share_ * facets_[1].reflection(wo_, wi, h, seen_[1]) : first;
  }
  double pdf(Vec3 wi) const {
    const Vec3 h = half_vector(wo_, wi);
    const double first = facets_[0].reflection_pdf(h, seen_[0]);
    return share_ > 0 ? (1 - share_) * first + share_ * facets_[1].reflection_pdf(h, seen_[1]) : first;
  }
  // `which` in [0, 1) chooses the population.
  Vec3 direction(Vec2 u, double which) const {
    return mirrored(wo_, facets_[which < share_ ? 1 : 0].visible_normal(wo_, u));
  }

 private:
  std::array<Facets<Slopes::ggx>, 2> facets_;
  double share_;
  std::array<double, 2> seen_;
  Vec3 wo_;
};

// Parameters of two lobes, direction and retro-reflection, as models declare them.
inline std::vector<manifest::ParameterInfo> gloss_parameters(double least_alpha) {
  return {{.name = "second_share",
           .unit = "1",
           .preset = 0,
           .lower = 0,
           .upper = 0.98,
           .meaning = "share of the facets that have the second roughness; 0: one lobe"},
          {.name = "second_alpha",
           .unit = "1",
           .preset = 0.4,
           .lower = least_alpha,
           .upper = 1,
           .meaning = "GGX roughness of the second lobe"},
          {.name = "anisotropy_0",
           .unit = "1",
           .preset = 0,
           .lower = -max_astigmatism,
           .upper = max_astigmatism,
           .meaning = "half the logarithm of the roughness along the tangent over that across it"},
          {.name = "anisotropy_45",
           .unit = "1",
           .preset = 0,
           .lower = -max_astigmatism,
           .upper = max_astigmatism,
           .meaning = "the same for the axes turned by 45 degrees"},
          {.name = "retro",
           .unit = "1",
           .preset = 0,
           .lower = 0,
           .upper = 1,
           .meaning = "share of the light that is sent back to where it came from"},
          {.name = "retro_alpha",
           .unit = "1",
           .preset = 0.3,
           .lower = 0.05,
           .upper = 1,
           .meaning = "width of the lobe that is sent back, as a GGX roughness"},
          {.name = "retro_falloff",
           .unit = "1",
           .preset = 0,
           .lower = 0,
           .upper = max_retro_falloff,
           .meaning = "power of the cosine by which the return falls"}};
}

}  // namespace gonio::surface
