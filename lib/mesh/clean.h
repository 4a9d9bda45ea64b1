// Cleaning of surfaces that were cut from volumes: ways to take the voxels' noise away, each measured.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

// Half-edge collapses by quadric error (Garland & Heckbert 1997) that keep the mesh manifold and flip no normal, down to
// `faces`. Returns how many are left (more where no collapse is allowed any more).
std::size_t decimate(io::TriangleMesh& mesh, std::size_t faces);

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

// Ours. Minimises the noise of normals under a bound on the distance to the data:
//   sum over pairs of neighbouring faces of a robust penalty of their normals' difference (feature-preserving: pairs that
//   differ by more than the noise explains are edges of the object and pay no more) subject to |x_v - data_v| <= within
// where data_v is the vertex's place on the volume's surface and moves are along normals alone; `sigma_m` (one per vertex,
// or empty) are the data's own uncertainties: what the data know well moves less. Alternates between filtered normals
// (bilateral in position and normal, Zheng et al. 2011) and vertices that follow them, projected on the bound.
struct BoundedWish {
  double within_m = 0;
  int rounds = 20;
  double feature_angle_rad = 0.5;          // normals that differ by more are never mixed
  std::vector<double> sigma_m{};
};
struct BoundedResult {
  int rounds = 0;
  double rms_move_m = 0, largest_move_m = 0;
  std::size_t at_bound = 0;                // vertices that the bound holds
  double normal_noise_before_rad = 0, normal_noise_after_rad = 0;  // normal_noise() below
};
BoundedResult clean_within(io::TriangleMesh& mesh, const BoundedWish& wish);

// Noise of normals without a reference: rms angle between a face's normal and that of a local quadratic fitted to its
// neighbourhood (three rings), faces at features left out (their residual exceeds 4 robust sd).
double normal_noise_rad(const io::TriangleMesh& mesh);

}  // namespace gonio::mesh
