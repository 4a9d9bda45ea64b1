// The two ways of others that ours is held against: Taubin's smoothing and the thesis's loop.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "mesh/clean.h"
#include "mesh/mesh.h"

namespace gonio::mesh {
namespace {

// Neighbours of each vertex, each once. A vertex of a border has those along the border alone, so that a border moves
// within itself.
struct VertexRings {
  std::vector<std::size_t> starts;
  std::vector<std::uint32_t> neighbours;
};

VertexRings rings_of(const io::TriangleMesh& mesh) {
  const VertexFaces around = faces_of_vertices(mesh.triangles, mesh.positions_m.size());
  VertexRings rings;
  rings.starts.push_back(0);
  std::vector<std::uint32_t> ends;
  for (std::uint32_t v = 0; v < mesh.positions_m.size(); ++v) {
    ends.clear();
    for (const std::uint32_t f : around.of(v))
      for (const std::uint32_t w : mesh.triangles[f])
        if (w != v) ends.push_back(w);
    std::sort(ends.begin(), ends.end());
    bool border = false;
    for (std::size_t i = 0; i < ends.size(); ++i)
      border |= (i == 0 || ends[i - 1] != ends[i]) && (i + 1 == ends.size() || ends[i + 1] != ends[i]);
    for (std::size_t i = 0, end = 0; i < ends.size(); i = end) {
      while (end < ends.size() && ends[end] == ends[i]) ++end;
      if (!border || end - i == 1) rings.neighbours.push_back(ends[i]);
    }
    rings.starts.push_back(rings.neighbours.size());
  }
  return rings;
}

// p + factor (mean of the neighbours - p)
void step_of_umbrella(const VertexRings& rings, double factor, const std::vector<Vec3>& from, std::vector<Vec3>& to) {
  parallel_for(
      0, from.size(),
      [&](std::size_t v) {
        const std::size_t first = rings.starts[v], last = rings.starts[v + 1];
        to[v] = from[v];
        if (first == last) return;
        Vec3 sum{};
        for (std::size_t i = first; i < last; ++i) sum += from[rings.neighbours[i]];
        to[v] += (sum / static_cast<double>(last - first) - from[v]) * factor;
      },
      4096);
}

std::size_t share_of(std::size_t faces, double share) {
  return static_cast<std::size_t>(std::llround(static_cast<double>(faces) * share));
}

}  // namespace

void smooth_taubin(io::TriangleMesh& mesh, int iterations, double lambda, double mu) {
  if (!(lambda > 0 && lambda < 1 && mu < -lambda))
    throw Error(
        Exit::usage, "mesh",
        "smoothing by lambda " + std::to_string(lambda) + " and mu " + std::to_string(mu) + " would shrink or blow up",
        "take 0 < lambda < 1 and mu < -lambda");
  const VertexRings rings = rings_of(mesh);
  std::vector<Vec3> other(mesh.positions_m.size());
  for (int i = 0; i < iterations; ++i) {
    step_of_umbrella(rings, lambda, mesh.positions_m, other);
    step_of_umbrella(rings, mu, other, mesh.positions_m);
  }
  if (!mesh.normals.empty()) mesh.normals = averaged_normals(mesh.positions_m, mesh.triangles);
}

// A closed surface has about two faces a vertex, whatever its size: shares of vertices are shares of faces.
void clean_by_subdivision(io::TriangleMesh& mesh, const SubdivisionLoop& wish) {
  decimate(mesh, share_of(mesh.triangles.size(), wish.first));
  for (int round = 0; round < wish.rounds; ++round) {
    subdivide_sqrt3(mesh);
    decimate(mesh, share_of(mesh.triangles.size(), wish.again));
  }
  if (!mesh.normals.empty()) mesh.normals = averaged_normals(mesh.positions_m, mesh.triangles);
}

}  // namespace gonio::mesh
