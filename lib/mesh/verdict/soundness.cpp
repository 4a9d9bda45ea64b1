// Edges and fans of a mesh whose vertices at one place count as one. The triangles at a vertex form one fan where their
// far edges, taken as a graph of the vertex's neighbours, hang together.
#include <algorithm>

#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/topology.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

// Triangles with three different corners, by welded vertices; collapsed and flat ones are counted.
std::vector<Corners> proper_triangles(const io::TriangleMesh& mesh, Soundness& sound) {
  const std::vector<std::uint32_t> same = welded(mesh.positions_m);
  std::vector<Corners> proper;
  proper.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.positions_m[a], q = mesh.positions_m[b], r = mesh.positions_m[c];
    if (!(norm(cross(q - p, r - p)) > 0)) ++sound.degenerate_triangles;
    const Corners t{same[a], same[b], same[c]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) proper.push_back(t);
  }
  std::vector<bool> used(mesh.positions_m.size());
  for (const Corners& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  sound.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  return proper;
}

// Edges, by sorting what leaves each vertex; returns how many there are.
std::size_t count_all_edges(const std::vector<Corners>& triangles, const VertexFaces& around, Soundness& sound) {
  std::size_t edges = 0;
  std::vector<std::pair<std::uint32_t, bool>> ends;  // of edges to higher vertices, and whether passed towards them
  for (std::uint32_t v = 0; v + 1 < around.starts.size(); ++v) {
    ends.clear();
    for (const std::uint32_t f : around.of(v))
      for (std::size_t c = 0; c < 3; ++c) {
        if (triangles[f][c] != v) continue;
        const std::uint32_t next = triangles[f][(c + 1) % 3], before = triangles[f][(c + 2) % 3];
        if (next > v) ends.emplace_back(next, true);
        if (before > v) ends.emplace_back(before, false);
      }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0, end = 0; i < ends.size(); i = end) {
      std::size_t forward = 0;
      for (end = i; end < ends.size() && ends[end].first == ends[i].first; ++end) forward += ends[end].second;
      const std::size_t all = end - i;
      ++edges;
      sound.boundary_edges += all == 1;
      sound.crowded_edges += all > 2;
      sound.disagreeing_edges += all > 1 && 2 * forward != all;
    }
  }
  return edges;
}

std::size_t fans_at(std::uint32_t v, const std::vector<Corners>& triangles, const VertexFaces& around) {
  std::vector<std::uint32_t> ring;
  for (const std::uint32_t f : around.of(v))
    for (const std::uint32_t w : triangles[f])
      if (w != v) ring.push_back(w);
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  const auto place = [&](std::uint32_t w) {
    return static_cast<std::uint32_t>(std::lower_bound(ring.begin(), ring.end(), w) - ring.begin());
  };
  UnionFind groups(ring.size());
  std::size_t fans = ring.size();
  for (const std::uint32_t f : around.of(v)) {
    const Corners& t = triangles[f];
    const std::size_t c = t[0] == v ? 0 : t[1] == v ? 1 : 2;
    fans -= groups.join(place(t[(c + 1) % 3]), place(t[(c + 2) % 3]));
  }
  return fans;
}

}  // namespace

Soundness soundness(const io::TriangleMesh& mesh) {
  Soundness sound;
  const std::vector<Corners> triangles = proper_triangles(mesh, sound);
  const std::size_t count = mesh.positions_m.size();
  const VertexFaces around = faces_of_vertices(triangles, count);
  const std::size_t edges = count_all_edges(triangles, around, sound);
  UnionFind pieces(count);
  std::size_t vertices = 0, joins = 0;
  for (const Corners& t : triangles) joins += pieces.join(t[0], t[1]) + pieces.join(t[1], t[2]);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (around.of(v).empty()) continue;
    ++vertices;
    sound.pinched_vertices += fans_at(v, triangles, around) > 1;
  }
  sound.components = vertices - joins;
  sound.euler = static_cast<std::int64_t>(vertices) - static_cast<std::int64_t>(edges) +
                static_cast<std::int64_t>(triangles.size());
  if (sound.closed() && sound.manifold())
    sound.genus_sum = (2 * static_cast<std::int64_t>(sound.components) - sound.euler) / 2;
  return sound;
}

}  // namespace gonio::mesh
