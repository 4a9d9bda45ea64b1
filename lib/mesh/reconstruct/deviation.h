// How far measured points lie from a mesh, along its normals, and over what their own covariances say.
#pragma once
#include "mesh/reconstruct.h"
#include "mesh/reconstruct/point_surface.h"

namespace gonio::mesh {

// Sets `deviation` and `deviation_m`. A point counts where the mesh is as near as its trimming reaches, and where the
// nearest place is not on the mesh's rim.
void deviate(const MeasuredPoints& points, const PointSurface& surface, const io::TriangleMesh& mesh,
             Reconstruction& made);

}  // namespace gonio::mesh
