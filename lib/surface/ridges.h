// Parallel ridges with the profile of a saw: long facets of the normal m, tilted by theta_r from the macroscopic normal
// n towards v, and short walls at right angles to them, which face +v's valleys. Local frame: u along the ridges,
// turned from +x by the azimuth; v = n x u; m = cos(theta_r) n + sin(theta_r) v. Facets are rough by Beckmann's
// distribution about m. Directions have z > 0.
//
// The profile is a right-angled triangle over the period L: facets have the length L cos(theta_r), walls L
// sin(theta_r). Let w be a direction projected onto the plane of n and v, at the angle theta_p from m.
//   Towards v the wall at the facet's lower end hides the strip L sin(theta_r) tan(theta_p) of it; the share that is
//   seen,
//     G1(w) = 1 - tan(theta_r) tan(theta_p) = (w.n) / (cos(theta_r) w.m),
//   is equation 2 of Luongo et al. 2017. Crests are level, so that nothing else can be in the way.
//   Away from v nothing hides the facet while w.m > 0: G1 = 1. (Their equation takes |tan(theta_p)|, that is, hides as
//   much on this side.) Both: G1(w) = min(1, (w.n) / (cos(theta_r) w.m)).
//   Both directions lose strips that begin at the same wall: what both see is the smaller share, G = min(G1(wi),
//   G1(wo)). (Their equation 1 multiplies the shares.)
// A unit of area carries cos(theta_r) of facets, so that their density of normals is cos(theta_r) D_m(h). (Their
// equation 4 has D_m itself: a mirror without roughness would reflect 1 / cos(theta_r) towards v.) With Smith's masking
// of the roughness about m, Gs,
//   f = F cos(theta_r) G Gs D_m(h) / (4 (wi.n) (wo.n)),
// and since Gs <= Gs1(wo) and the normals that wo sees have the total area wo.m,
//   integral of f (wi.n) dwi <= cos(theta_r) G1(wo) (wo.m) / (wo.n) <= 1.
// Light by way of the walls, and reflected twice, is in surface/ridge_walls.h; tests/surface/ridged_test.cpp says how
// much that is.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"
#include "surface/slopes.h"

namespace gonio::surface {

class Ridges {
 public:
  Ridges(double ridge_rad, double alpha_u, double alpha_v, double azimuth_rad)
      : cos_(std::cos(ridge_rad)),
        sin_(std::sin(ridge_rad)),
        u_{std::cos(azimuth_rad), std::sin(azimuth_rad), 0},
        v_{-u_.y, u_.x, 0},
        facets_(Roughness{alpha_u, (1 - alpha_v / alpha_u) / 0.9, 0}) {}

  Vec3 to_facet(Vec3 w) const {  // (u, v cos - n sin, m)
    const double along = dot(w, v_);
    return {dot(w, u_), cos_ * along - sin_ * w.z, sin_ * along + cos_ * w.z};
  }
  Vec3 from_facet(Vec3 w) const {
    return u_ * w.x + v_ * (cos_ * w.y + sin_ * w.z) + Vec3{0, 0, cos_ * w.z - sin_ * w.y};
  }
  // The BRDF for a Fresnel factor of one; wof, wif: in the facet's frame, above its horizon.
  double lobe(Vec3 wo, Vec3 wi, Vec3 wof, Vec3 wif) const {
    const double ao = wof.z / wo.z, ai = wif.z / wi.z;
    const double seen = std::min({ao * ai * cos_, ao, ai});  // cos(theta_r) G ao ai
    return seen * facets_.reflection(wof, wif, half_vector(wof, wif), facets_.area_seen(wof));
  }
  double pdf(Vec3 wof, Vec3 wif) const { return facets_.reflection_pdf(half_vector(wof, wif), facets_.area_seen(wof)); }
  Vec3 visible_normal(Vec3 wof, Vec2 u) const { return facets_.visible_normal(wof, u); }

 private:
  double cos_, sin_;
  Vec3 u_, v_;
  Facets<Slopes::beckmann> facets_;
};

}  // namespace gonio::surface
