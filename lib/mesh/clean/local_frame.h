// A triangle's plane as coordinates: u and v along it, h over it, in units of the mean edge.
#pragma once
#include "mesh/clean/neighbourhood.h"

namespace gonio::mesh {

struct LocalPlace {
  double u, v, h;
};

class LocalFrame {
 public:
  LocalFrame(const NoisySurface& surface, std::uint32_t face)
      : basis_(surface.faces[face].guide),
        centre_(surface.faces[face].centroid),
        edge_(surface.edge_m),
        per_edge_(1 / surface.edge_m) {}
  LocalPlace of(Vec3 p) const {
    const Vec3 local = basis_.to_local(p - centre_) * per_edge_;
    return {local.x, local.y, local.z};
  }
  Vec3 out(double u, double v, double h) const { return centre_ + basis_.to_world({u, v, h}) * edge_; }
  Vec3 direction(Vec3 local) const { return basis_.to_world(local); }

 private:
  Basis basis_;
  Vec3 centre_;
  double edge_, per_edge_;
};

}  // namespace gonio::mesh
