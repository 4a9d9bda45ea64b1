// ct.scale on where a wall stands along its outward normal, voxels; and on where a point of the volume really is.
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

// The other way round: a place that the volume says, to where it is. x: from the volume's centre.
constexpr Vec3 ct_scale_undone(Vec3 x_m, double scale, double axial) {
  return {x_m.x / (1 + scale), x_m.y / (1 + scale), x_m.z / (1 + scale + axial)};
}

}  // namespace gonio::equation
