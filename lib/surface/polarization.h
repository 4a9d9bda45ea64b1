// Mueller matrices of surfaces, put together from those of Fresnel and from parts that lose polarization. All are
// divided by their (0, 0) element and refer to the s axis of wi and wo; frames: optics/mueller.h. Local directions.
#pragma once
#include <algorithm>

#include "optics/mueller_algebra.h"
#include "surface/surface.h"

namespace gonio::surface {

inline optics::Mueller reflected_by(double cosine, optics::Complex eta) {
  return optics::normalised(optics::fresnel_reflection(cosine, eta));
}
inline optics::Mueller refracted_by(double cosine, double eta) {
  return optics::normalised(optics::fresnel_transmission(cosine, eta));
}

// The facet that takes light from wi to wo: reflected, or refracted from the medium beyond; eta: index beyond over the
// index on wo's side.
optics::Mueller dielectric_facet(double eta, Vec3 wo, Vec3 wi);

// The parts of one law mix by what they contribute to f: `share` of the first, in [0, 1].
inline optics::Mueller mixed(const optics::Mueller& a, const optics::Mueller& b, double share) {
  return a * share + b * (1 - share);
}
// What of a law is `part`; `all` may be zero.
inline double share_of(double part, double all) {
  return all > 0 ? std::clamp(part / all, 0.0, 1.0) : 0;
}

// (T_s - T_p) / (T_s + T_p) of a smooth dielectric seen from outside, relative index eta >= 1.
double transmitted_diattenuation(double cosine, double eta);

// A matte base beneath a smooth dielectric interface of relative index eta: the base loses all polarization, and light
// leaves polarized in the plane of emergence (Atkinson & Hancock 2006, "Recovery of surface orientation from diffuse
// polarization", IEEE Transactions on Image Processing 15(6), equation 3), as it enters by the same law. The planes of
// refraction contain the normal, and are turned against that of wi and wo. For rough interfaces an approximation: that
// of their mean normal.
optics::Mueller matte_beneath(double eta, Vec3 wo, Vec3 wi);

// Any base beneath it: `base` refers to the frames of the refracted directions `wi_inside` and `wo_inside`.
optics::Mueller beneath(const optics::Mueller& base, double eta, Vec3 wo, Vec3 wo_inside, Vec3 wi, Vec3 wi_inside);

}  // namespace gonio::surface
