// Cleaning of surfaces that were cut from volumes: ways to take the voxels' noise away, each measured.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

// Half-edge collapses by quadric error (Garland & Heckbert 1997) that keep the mesh manifold and flip no normal, down
// to `faces`. Returns how many are left (more where no collapse is allowed any more). What stays, stays where it was;
// `kept`: the vertices' numbers before, ascending.
std::size_t decimate(io::TriangleMesh& mesh, std::size_t faces, std::vector<std::uint32_t>* kept = nullptr);

// sqrt(3) subdivision (Kobbelt 2000), once.
void subdivide_sqrt3(io::TriangleMesh& mesh);

// The thesis's way: decimation to `first` of the vertices, then `rounds` times sqrt(3) subdivision and decimation to
// `again` of the vertices.
struct SubdivisionLoop {
  double first = 0.01, again = 0.33;
  int rounds = 4;
};
void clean_by_subdivision(io::TriangleMesh& mesh, const SubdivisionLoop& wish = {});

// Taubin 1995: lambda | mu smoothing with uniform weights; pass band k = 1 / lambda + 1 / mu.
void smooth_taubin(io::TriangleMesh& mesh, int iterations = 20, double lambda = 0.5, double mu = -0.53);

// Ours. Local quadratics at every triangle, each over as wide a neighbourhood as the data there bear: it grows while
// the slopes agree with those of all narrower ones within their noise, and while what the quadratic leaves is the
// noise's (intersection of confidence intervals, Goldenshluger & Nemirovski 1997). Planes get much averaging, tight
// curves little. Edges of the object are not crossed, and a vertex goes where the surfaces of its triangles agree: to
// the intersection of both sides at an edge. A quadratic's slope has no bias on planes, balls and tubes, and everything
// is estimated from the data, not from smoothed data: nothing shrinks. Then |x_v - data_v| <= within_m, strictly; what
// would intersect stays where the data have it. Normals are those of the estimated surfaces.
struct BoundedWish {
  double within_m = 0;
  int rounds = 2;                  // the second knows the edges from the first's normals
  double feature_angle_rad = 0.5;  // between neighbouring triangles, noise taken off: an edge of the object from here
  // The data's own uncertainties, one a vertex or none. Their ratios count; with alike_m they are taken for what they
  // say, because what errors that neighbours share leave behind is hard to tell from shape.
  std::vector<double> sigma_m{};
  double alike_m = 0;  // vertices nearer than this were read from the same data, and err alike; 0: not known
};
struct BoundedResult {
  int rounds = 0;
  double sigma_m = 0;        // noise of the vertices along the normals, as found in the data or stated
  double inflation = 1;      // by how much its correlation makes the variance of wide fits larger
  double mean_radius_m = 0;  // of the neighbourhoods
  std::size_t sharp_edges = 0;
  double rms_move_m = 0, largest_move_m = 0;
  std::size_t at_bound = 0;  // vertices that the bound holds
  std::size_t undone = 0;    // vertices put back because triangles would have intersected
  double normal_noise_before_rad = 0, normal_noise_after_rad = 0;  // normal_noise() below
};
BoundedResult clean_within(io::TriangleMesh& mesh, const BoundedWish& wish);

// Noise of normals without a reference: rms angle between a face's normal and that of a local quadratic fitted to its
// neighbourhood (three rings), faces at features left out (their residual exceeds 4 robust sd).
double normal_noise_rad(const io::TriangleMesh& mesh);

}  // namespace gonio::mesh
