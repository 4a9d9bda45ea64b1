// The surface of a volume at a threshold: dual contouring that is closed, 2-manifold, oriented and free of
// self-intersections by construction.
//
// A voxel is inside where its value exceeds the threshold; whatever lies beyond the volume's border is outside, so that
// an object that the border cuts is closed there. A grid cell is the cube between eight voxel centres. Every sheet of
// the surface that passes through a cell gets a vertex of its own, at the minimum of the quadratic error of Hermite data
// (crossing points and gradients, Ju et al. 2002; minimum-norm over singular directions), held strictly within the cell
// and, where several sheets share it, within the convex region of its own sheet. Every crossed grid edge gives a polygon
// round it.
//
// Why nothing intersects (Ju & Udeshi 2006, on a uniform grid): two cells that share a face are convex together, so the
// segment between their vertices crosses that face, and the polygon round an edge split into triangles at the edge's
// crossing point stays within the tetrahedra between the edge and pairs of neighbouring vertices (its envelope);
// envelopes of different edges have no common interior. The plain quad (two triangles) is taken where it lies within
// the envelope. Faces whose four edges are all crossed, and faces of cells with several sheets, are drawn explicitly:
// straight segments between crossing points, so that sheets never share an edge. Sheets of one cell are separated by
// planes (x + y + z = 1 round a lone corner, x + y = 1 between opposite edges).
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
