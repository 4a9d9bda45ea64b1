// ct.scale on where a wall stands along its outward normal, voxels.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_scale();
}

namespace gonio::equation {

// x: the place from the volume's centre, n: the outward normal; the rotation axis is z.
inline double ct_scale(double s, double scale, double axial, Vec3 x_m, Vec3 n, double voxel_m) {
  return s + (scale * dot(x_m, n) + axial * x_m.z * n.z) / voxel_m;
}

}  // namespace gonio::equation
