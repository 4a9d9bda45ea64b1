// Light sent back to where it came from, by corner cubes, beads and crossed fibres: facets that see the direction
// opposite to the mirrored one, and that lose light as they are turned away,
//   f = lobe(wi, wo') (cos_i cos_o)^(falloff / 2),   wo' = (-wo_x, -wo_y, wo_z)
// with the GGX lobe D G2 / (4 cos_i cos_o) of surface/microfacet.h. The half vector of wi and wo' keeps its height when
// the two change places, so that the lobe is reciprocal (after the back vector of Belcour et al. 2025).
// Where wi = wo the coefficient of retro-reflection R_A = f cos_i cos_o (EN 12899-1) falls with cos^falloff: road signs
// are asked for an exponent of 3 (class RA2: 250, 150, 110 cd/(lx m^2) at 5, 30, 40 degrees) to 7 (RA1), beads that lie
// open keep theirs. T: double, or a dual number for slopes by roughness and exponent.
#pragma once
#include <cmath>

#include "surface/interface_loss.h"
#include "surface/microfacet.h"

namespace gonio::surface {

inline constexpr double max_retro_falloff = 8;

inline Vec3 sent_back(Vec3 wo) {
  return {-wo.x, -wo.y, wo.z};
}

template <class T>
class RetroLobeOf {
 public:
  RetroLobeOf(const T& alpha, const T& falloff) : facets_(alpha), falloff_(falloff) {}

  T lobe(Vec3 wo, Vec3 wi) const {
    using std::exp;
    const Vec3 from = sent_back(wo);
    return facets_.lobe(from, wi, half_vector(from, wi)) * exp(0.5 * (std::log(wi.z) + std::log(wo.z)) * falloff_);
  }

 protected:
  GgxOf<T> facets_;
  T falloff_;
};

// With a sampler, and what is sent back altogether.
class RetroLobe : public RetroLobeOf<double> {
 public:
  RetroLobe(double alpha, double falloff) : RetroLobeOf(alpha, falloff), alpha_(alpha) {}

  double pdf(Vec3 wo, Vec3 wi) const {
    const Vec3 from = sent_back(wo);
    return facets_.pdf(from, half_vector(from, wi));
  }
  Vec3 direction(Vec3 wo, Vec2 u) const {
    const Vec3 from = sent_back(wo);
    return mirrored(from, facets_.visible_normal(from, u));
  }
  // Share of the light that would be sent back without the fall-off: for choosing between lobes.
  double power_at_most(Vec3 wo) const { return 1 - InterfaceLoss::mirror(Slopes::ggx, {alpha_, 0, 0}).towards(wo); }
  // Share that is sent back, within 0.012: the mean over visible normals where there is a fall-off, on one side of the
  // plane of incidence.
  double power(Vec3 wo) const {
    if (!(falloff_ > 0)) return power_at_most(wo);
    constexpr int rings = 12, turns = 4;
    const Vec3 from = sent_back(wo);
    double sum = 0;
    for (int k = 0; k < rings * turns; ++k) {
      const Vec3 wi = direction(wo, {(k / turns + 0.5) / rings, (k % turns + 0.5) / (2 * turns) - 0.25});
      if (wi.z > 0) sum += facets_.weight(from, wi) * std::pow(wi.z * wo.z, 0.5 * falloff_);
    }
    return sum / (rings * turns);
  }

 private:
  double alpha_;
};

}  // namespace gonio::surface
