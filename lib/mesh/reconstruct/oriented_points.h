// Points with outward normals, for Poisson reconstruction: the two chains of reconstruct.h.
#pragma once
#include "mesh/reconstruct.h"
#include "mesh/reconstruct/point_surface.h"

namespace gonio::mesh {

struct OrientedPoints {
  std::vector<Vec3> positions_m, normals;
  bool by_length = false;  // normals' lengths are confidences, 1 the usual one
};

// View by view: resampled, planes through the nearest samples, normals turned to the camera and carried to the view's
// points, each from its nearest sample.
OrientedPoints oriented_by_planes(const MeasuredPoints& points, const ReconstructionWish& wish);

// All views together: resampled, each sample moved to the surface that the points about it show. Confidence: the usual
// standard deviation over the sample's own, at most 2 and at least 1/2.
OrientedPoints oriented_by_surface(const PointTree& tree, const PointSurface& surface, const ReconstructionWish& wish);

}  // namespace gonio::mesh
