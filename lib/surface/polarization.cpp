#include "surface/polarization.h"

#include "surface/microfacet.h"
#include "surface/refraction.h"

namespace gonio::surface {
namespace {

using optics::Mueller;

// The axis perpendicular to `w` and to the normal; any where they are parallel.
Vec3 refraction_axis(Vec3 w) {
  const double sine = std::hypot(w.x, w.y);
  return sine > 1e-9 ? Vec3{-w.y / sine, w.x / sine, 0} : Basis(w).t;
}

}  // namespace

Mueller dielectric_facet(double eta, Vec3 wo, Vec3 wi) {
  if (wi.z > 0) return reflected_by(dot(wo, half_vector(wo, wi)), eta);
  if (matched(eta)) return optics::identity_mueller();
  const Vec3 h = refracting_normal(wo, wi, eta);
  return h.z > 0 ? refracted_by(dot(wo, h), eta) : Mueller::depolarizer();
}

double transmitted_diattenuation(double cosine, double eta) {
  if (eta == 1) return 0;
  const optics::Amplitudes r = optics::reflected_amplitudes(cosine, eta);
  const double s = 1 - std::norm(r.s), p = 1 - std::norm(r.p);
  return s + p > 0 ? (s - p) / (s + p) : 0;
}

Mueller matte_beneath(double eta, Vec3 wo, Vec3 wi) {
  const Vec3 axis = optics::scattering_axis(wi, wo);
  Mueller matte;
  const double out = transmitted_diattenuation(wo.z, eta), in = transmitted_diattenuation(wi.z, eta);
  matte(0, 0) = 1;
  matte(1, 0) = out;
  matte(0, 1) = in;
  matte(1, 1) = out * in;
  return optics::frame_change(wo, refraction_axis(wo), axis) * matte *
         optics::frame_change(-wi, axis, refraction_axis(wi));
}

Mueller beneath(const Mueller& base, double eta, Vec3 wo, Vec3 wo_inside, Vec3 wi, Vec3 wi_inside) {
  using optics::frame_change;
  const Vec3 axis = optics::scattering_axis(wi, wo), axis_inside = optics::scattering_axis(wi_inside, wo_inside);
  const Vec3 in = refraction_axis(wi), out = refraction_axis(wo);  // on both sides of the interface
  return optics::normalised(
      frame_change(wo, out, axis) * refracted_by(wo_inside.z, 1 / eta) * frame_change(wo_inside, axis_inside, out) *
      base * frame_change(-wi_inside, in, axis_inside) * refracted_by(wi.z, eta) * frame_change(-wi, axis, in));
}

}  // namespace gonio::surface
