// The diffusive part of a BSSRDF: light that enters a half space at one point and leaves it at another. Object frame,
// metres; per band.
#pragma once
#include "geom/vector.h"

namespace gonio::surface {

struct SubsurfaceEntry {
  Vec3 position_m, normal;  // outwards
  Vec3 inward;              // unit direction of the refracted light within the medium
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
  virtual double reach_m() const = 0;  // entries farther away are left out
};

}  // namespace gonio::surface
