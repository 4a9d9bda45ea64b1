// Mean curvature at the vertices of a triangle mesh: the cotangent operator over mixed Voronoi areas.
//   K(v) = 1 / (2 A(v)) sum over edges vw of (cot a + cot b) (v - w) = 2 H n    Meyer, Desbrun, Schroeder & Barr 2003,
//                                                                            equation 8; A: their figure 4
//   value(v) = -K(v).n(v) / 2, n the vertex normal
// Per metre; the mean of the two principal curvatures, negative where the object bulges (a ball of radius r: -1 / r),
// positive where it is hollow. Scale: a mesh twice as large has half of it.
//
// The operator needs a closed ring of triangles. Vertices on a border, and on seams where a file repeats vertices, take
// the mean of their neighbours that have one, 0 where none has. A scan's noise of depth s on triangles with edges of
// length e gives curvatures of the order s / e^2.
#pragma once
#include <vector>

#include "mesh/mesh.h"

namespace gonio::mesh {

std::vector<float> mean_curvature_per_m(const Mesh& mesh);

}  // namespace gonio::mesh
