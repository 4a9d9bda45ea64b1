// Edges of a mesh, sorted, so that the triangles of each stand together. The volume is the sum of the signed tetrahedra
// over a vertex: V = 1/6 sum a.(b x c).
#include "mesh/topology.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/union_find.h"

namespace gonio::mesh {
namespace {

using Corners = std::array<std::uint32_t, 3>;

bool before(Vec3 a, Vec3 b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

struct Edge {
  std::uint32_t low, high;
  bool forward;  // passed from low to high
  bool operator<(const Edge& o) const {
    return low != o.low ? low < o.low : high != o.high ? high < o.high : forward < o.forward;
  }
  bool same_place(const Edge& o) const { return low == o.low && high == o.high; }
};

// Pieces of the graph of boundary edges: its vertices less the joins that connect them.
std::size_t count_holes(const std::vector<Edge>& boundary, std::size_t vertices) {
  if (boundary.empty()) return 0;
  UnionFind pieces(vertices);
  std::vector<bool> seen(vertices);
  std::size_t corners = 0, joins = 0;
  for (const Edge& edge : boundary) {
    for (const std::uint32_t v : {edge.low, edge.high})
      if (!seen[v]) {
        seen[v] = true;
        ++corners;
      }
    joins += pieces.join(edge.low, edge.high);
  }
  return corners - joins;
}

void count_edges(std::vector<Edge>& edges, std::size_t vertices, Topology& topology) {
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> boundary;
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    std::size_t forward = 0;
    for (end = i; end < edges.size() && edges[end].same_place(edges[i]); ++end) forward += edges[end].forward;
    const std::size_t all = end - i;
    if (all == 1) boundary.push_back(edges[i]);
    if (all > 2) ++topology.crowded_edges;
    if (all > 1 && 2 * forward != all) ++topology.disagreeing_edges;
  }
  topology.boundary_edges = boundary.size();
  topology.holes = count_holes(boundary, vertices);
}

}  // namespace

std::vector<std::uint32_t> welded(const std::vector<Vec3>& p) {
  std::vector<std::uint32_t> order(p.size()), same(p.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return before(p[a], p[b]); });
  for (std::size_t i = 0; i < order.size(); ++i)
    same[order[i]] = i > 0 && p[order[i]] == p[order[i - 1]] ? same[order[i - 1]] : order[i];
  return same;
}

Topology topology_of(const Mesh& mesh) {
  Topology topology;
  const std::vector<std::uint32_t> same = welded(mesh.positions_m);
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  const Vec3 origin = mesh.positions_m.at(0);
  for (const Corners& t : mesh.triangles) {
    const Corners c{same[t[0]], same[t[1]], same[t[2]]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
      ++topology.collapsed_triangles;
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = c[i], b = c[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
    const auto& p = mesh.positions_m;
    topology.volume_m3 += dot(p[c[0]] - origin, cross(p[c[1]] - origin, p[c[2]] - origin)) / 6;
  }
  count_edges(edges, mesh.positions_m.size(), topology);
  return topology;
}

}  // namespace gonio::mesh
