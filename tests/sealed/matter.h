// What matter sends back, by equations of the makers' own: coats by microfacets with the exact Fresnel reflectance,
// rough matte bases after Oren & Nayar's full model, lobes with a heavy tail, stretched lobes, and light sent back to
// the lamp.
#pragma once
#include <array>

#include "geom/vector.h"

namespace gonio::sealed {

class CoatAlbedo;

struct Matter {
  Rgb albedo{0.5, 0.5, 0.5};
  double f0 = 0, alpha = 0.2;           // of a clear coat; none where f0 is 0
  double slope_rad = 0;                 // of the matte base (Oren & Nayar 1994)
  double tail = 0, tail_alpha = 0.5;    // share of the coat's facets that are far rougher
  double stretch = 1;                   // alpha along x over alpha along y
  const CoatAlbedo* coat = nullptr;     // given: what is lost at it counts its roughness, too
  double retro = 0, retro_width = 0.2;  // share sent back to the lamp, in a lobe of this width (rad)
};
// A coat of matter: what it sends back altogether, against the cosine; facets drawn by their slopes on a lattice.
class CoatAlbedo {
 public:
  CoatAlbedo(double f0, double alpha);
  double at(double cosine) const;
  double mean() const { return mean_; }  // over the hemisphere, by the cosine

 private:
  static constexpr int nodes = 24;
  std::array<double, nodes> sent_back_{};
  double mean_ = 0;
};
struct Scattering {
  Rgb base;         // f of the matte base without its albedo, 1/sr
  double coat = 0;  // f of everything else, 1/sr
};
struct Polarized {  // light that comes in: share along `axis` less the share across
  Vec3 axis;
  double degree = 0;
};
// Directions from the surface, unit; `x`: the surface's own direction, across n.
Scattering scatter(const Matter& m, Vec3 n, Vec3 x, Vec3 wi, Vec3 wo, const Polarized& light = {});
double fresnel(double cosine, double f0);  // dielectric, unpolarized, exact
// The same for light from wi that is polarized, at a facet with the normal h.
double fresnel(const Polarized& light, Vec3 wi, Vec3 h, double f0);
// What facets of GGX would send back if each reflected all light, 1/sr; roughness ax along x, ay across.
double facets(double ax, double ay, Vec3 n, Vec3 x, Vec3 wi, Vec3 wo);

}  // namespace gonio::sealed
