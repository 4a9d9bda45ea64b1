// Is a mesh fit to be rendered as glass? Closed, 2-manifold, oriented, without self-intersections; its genus; how far
// it is from where the data put the surface; and what the noise of its normals does to light.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

struct Soundness {
  std::size_t components = 0, boundary_edges = 0, crowded_edges = 0, disagreeing_edges = 0;
  std::size_t pinched_vertices = 0;  // whose triangles form more than one fan
  std::size_t degenerate_triangles = 0, unused_vertices = 0;
  std::int64_t euler = 0;      // vertices - edges + faces
  std::int64_t genus_sum = 0;  // (2 components - euler) / 2 where closed and manifold
  bool closed() const { return boundary_edges == 0 && disagreeing_edges == 0; }
  bool manifold() const { return crowded_edges == 0 && pinched_vertices == 0; }
};
Soundness soundness(const io::TriangleMesh& mesh);

// Pairs of triangles that intersect other than in what they share, exact predicates (CGAL), on the coordinates as they
// are. Stops after `at_most` pairs.
std::vector<std::pair<std::uint32_t, std::uint32_t>> self_intersections(const io::TriangleMesh& mesh,
                                                                        std::size_t at_most = 1000);
// Pairs (triangle of a, triangle of b) that meet, if only in a point; likewise exact.
std::vector<std::pair<std::uint32_t, std::uint32_t>> intersections(const io::TriangleMesh& a, const io::TriangleMesh& b,
                                                                   std::size_t at_most = 1000);

// Distances from points spread evenly over `from` (area-weighted, seeded, plus all vertices) to the surface `to`.
struct Distance {
  double rms_m = 0, mean_m = 0, largest_m = 0, p99_m = 0;
  double mean_signed_m = 0;  // positive: outside `to`, where `to` is closed
  std::size_t samples = 0;
};
Distance distance(const io::TriangleMesh& from, const io::TriangleMesh& to, std::size_t samples, std::uint64_t seed);

// From each point to the surface: positive outside, where it is closed.
std::vector<double> signed_distances(const std::vector<Vec3>& points_m, const io::TriangleMesh& to);

// rms angle between the normals of `mesh` (at the corners of its triangles, its own where it has them, weighted by
// area) and those of the nearest point of `reference` (interpolated from its vertices' own or averaged normals).
double normals_rms_rad(const io::TriangleMesh& mesh, const io::TriangleMesh& reference);

// A ray through both walls: rays with `directions` spread over the sphere are refracted at every crossing by index
// `eta` with the mesh's (interpolated) normals; the exit direction against that of the reference. rms over rays that
// leave both after the same number of crossings.
struct RayBend {
  double rms_rad = 0, median_rad = 0, p95_rad = 0;
  std::size_t rays = 0, differing_paths = 0;
};
RayBend ray_bend(const io::TriangleMesh& mesh, const io::TriangleMesh& reference, double eta, std::size_t rays,
                 std::uint64_t seed);
// Without a reference: normals are disturbed by `normal_noise_rad`, independently at each crossing; what the exit
// direction changes by.
RayBend ray_bend_of_noise(const io::TriangleMesh& mesh, double normal_noise_rad, double eta, std::size_t rays,
                          std::uint64_t seed);

}  // namespace gonio::mesh
