// The surface of a volume at a threshold: dual contouring that is closed, 2-manifold, oriented and free of
// self-intersections by construction.
//
// A voxel is inside where its value exceeds the threshold (one that equals it is outside). What lies beyond the volume's
// border counts as outside: an object that the border cuts is closed there by a flat cap half a voxel beyond its last
// samples, where their voxels end. A cell is the cube between eight voxel centres. Every sheet of the surface that passes
// through a cell gets a vertex of its own, at the minimum of the quadratic error of Hermite data (crossing points and
// gradients, Ju et al. 2002; minimum-norm over singular directions), held strictly within the cell and, where several
// sheets share it, within the convex region of its own sheet (cell_cases.h). Every crossed grid edge gives a polygon.
//
// Why nothing intersects. (1) On the faces of the cells draw segments between crossings (cell_cases.h): simple closed
// loops on the boundary of every cell, one for each sheet. The cone over a loop from the sheet's vertex is a disk that
// does not intersect itself, since the vertex is an interior point of a convex body and the loop lies on its boundary;
// cones of one cell lie in convex regions that do not meet; a tunnel cell (two loops of one component) has a strip that
// rises from one loop to the other, star-shaped round the diagonal. Cells meet in the segments alone: the surface is
// embedded. (2) On a face with one segment p q between two cells with one sheet each, replace it by the path p m q, where
// m is the point where the line between the two vertices passes the face: strictly within it, because two neighbouring
// cells are convex together. The loops stay simple, so the surface stays embedded; its triangles over p m and m q join
// to those with corners (p, vertex, vertex) and (q, vertex, vertex) (Ju & Udeshi 2006). All other faces keep their
// segments: ambiguous ones, and those of cells with several sheets, so that no edge is shared by four polygons. (3) Where
// all four faces round an edge are of the first kind, its four triangles round the crossing lie in the edge's envelope,
// the four tetrahedra between the edge and neighbouring vertices. Envelopes meet in their boundaries only, so whatever
// spans the same four edges inside one may take their place: two triangles, if a diagonal stays in it (polygons.cpp).
//
// All this holds for the coordinates as they are stored: crossings are 2^-7 or more from the ends of their edges, and the
// margins of the vertices (sheet_vertex.h) exceed the rounding to single precision; axes of more than 8190 voxels are
// refused. Not covered: other positions. Whoever moves vertices has to check again.
//
// Topology: that of the voxels, `inside` counting 26 neighbours and outside 6, or the reverse. With 26, voxels that touch
// in an edge or a corner are joined; with 6 they are separate. The Euler number of the surface is twice that of the
// solid: topology.h counts it from the voxels alone.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geom/vector.h"
#include "io/volume.h"

namespace gonio::volume {

enum class Connectivity { six, twenty_six };

struct ContourWish {
  double threshold = 0;
  Connectivity inside = Connectivity::twenty_six;
  // true: QEF of crossings and gradients (sharp edges stay sharp); false: mean of the crossings (labels, very noisy data)
  bool hermite = true;
  double sharpness = 0.1;  // singular values of the QEF below this share of the largest are left out
};

// Positions in index coordinates (voxel centres at integers), single precision; normals unit, from the volume's gradient
// at the vertex (central differences, trilinear), pointing to smaller values: outwards. Counter-clockwise seen from
// outside where the volume's axes are right-handed; the caller turns them where they are not.
struct Contour {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 3>> normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::size_t crossed_edges = 0, split_polygons = 0, shared_cells = 0;  // how often which case occurred
};

// Streams the volume once, slab by slab: memory is that of the result and of a few slices. The result does not depend on
// the number of threads. Error(data) where more than 2^32 - 1 vertices would be needed.
Contour contour(io::VolumeSource& source, const ContourWish& wish);

}  // namespace gonio::volume
