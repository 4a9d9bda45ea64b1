// The diffusive part of a BSSRDF: light that enters a half space at one point and leaves it at another. Object frame,
// metres; per band.
//
// Radiance that leaves at x_o towards wo (Jensen et al. 2001, equations 1-5; wo, wi local to the two normals):
//   L_o(x_o, wo) = T(wo) integral over x_i, wi of  S_d(x_i, w12(wi); x_o) T(wi) L_i(x_i, wi) cos(theta_i) dwi dA
// T is what the interface lets pass, 1 - F where it is smooth and 1 - E, E its directional reflectance, where it is
// rough. S_d holds the normalisation 1 / (pi T_mean), T_mean = integral of T cos / pi, so that the exitance that
// diffusion theory states is what leaves: integral of L_o cos dwo = M.
#pragma once
#include "geom/vector.h"
#include "surface/medium.h"

namespace gonio::surface {

struct Values;

struct SubsurfaceEntry {
  Vec3 position_m, normal;  // outwards
  Vec3 inward;              // unit direction of the refracted light within the medium
};

// Light after the interface; local frame of the point.
struct Entrance {
  double share = 0;  // that passes
  Vec3 onwards;      // where it goes
};

// Light that the refracted ray itself meets, beside the diffuse part: S* of the thesis' equations 7-9.
struct StraightLight {
  Medium medium;            // in which the ray is attenuated
  double single = 0;        // factor on light that is scattered once on the way
  double single_share = 0;  // of paths to spend on it
  bool passes = false;      // rays that meet the far side leave through it
};

class Subsurface {
 public:
  virtual ~Subsurface() = default;
  // S_d(x_i, w12; x_o) in 1/(m^2 sr), without the Fresnel transmittances of either interface: radiance that leaves
  // diffusely at `exit_m` beneath the interface per flux that enters.
  virtual Rgb evaluate(const SubsurfaceEntry& entry, Vec3 exit_m, Vec3 exit_normal) const = 0;
  // Distances on a plane, drawn for `band`: density per area, so that 2 pi r density integrates to one.
  virtual double sample_distance(int band, double u) const = 0;
  virtual double distance_density(int band, double distance_m) const = 0;
  virtual double reach_m() const = 0;  // entries farther away are left out; 0: no diffuse part

  // What passes the interface at a point with `values`. Where S_d depends on the direction and the interface is rough,
  // `u` draws the facet: the mean over u is the interface's transmittance, its directions those of refraction there.
  virtual Entrance enter(const Values& values, Vec3 wi, Vec2 u) const = 0;
  // The same outwards: `travel`, within, meets the interface from below (z > 0); share 0 where all is reflected.
  virtual Entrance leave(const Values& values, Vec3 travel, Vec2 u) const = 0;
  virtual double eta() const = 0;  // index within over index outside
  virtual const StraightLight* straight() const { return nullptr; }
};

}  // namespace gonio::surface
