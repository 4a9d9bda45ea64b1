// See edges.h.
#include "mesh/mend/edges.h"

#include <cmath>

#include "base/union_find.h"

namespace gonio::mesh {
namespace {

constexpr double same_angle_rad = 1e-9;
constexpr std::uint32_t corners = 3;

// Behind every corner 3 f + c, whose edge leads from it to the next, the corner of the triangle that it is joined to.
using Partners = std::vector<std::uint32_t>;

void join(Partners& partners, const MeshEdge& a, const MeshEdge& b) {
  partners[corners * a.face + a.corner] = corners * b.face + b.corner;
  partners[corners * b.face + b.corner] = corners * a.face + a.corner;
}

// By the angle about the edge, from low to high, at which they lie. Of those at one angle the ones that face forwards
// come first: between them and the others is nothing.
std::vector<MeshEdge> round_the_edge(const io::TriangleMesh& mesh, std::span<const MeshEdge> edge) {
  const Vec3 low = mesh.positions_m[edge[0].low];
  const Basis frame(normalized(mesh.positions_m[edge[0].high] - low));
  std::vector<std::pair<double, MeshEdge>> placed;
  for (const MeshEdge& e : edge) {
    const Vec3 local = frame.to_local(mesh.positions_m[mesh.triangles[e.face][(e.corner + 2) % corners]] - low);
    placed.emplace_back(std::atan2(local.y, local.x), e);
  }
  std::stable_sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  // Angles at both ends of the circle are one.
  while (placed.size() > 1 && placed.back().first > placed.front().first + 2 * pi - same_angle_rad) {
    placed.back().first = placed.front().first;
    std::rotate(placed.begin(), placed.end() - 1, placed.end());
  }
  std::vector<MeshEdge> order;
  for (std::size_t i = 0, end = 0; i < placed.size(); i = end) {
    for (end = i + 1; end < placed.size() && placed[end].first <= placed[i].first + same_angle_rad;) ++end;
    for (const bool forward : {true, false})
      for (std::size_t k = i; k < end; ++k)
        if (placed[k].second.forward == forward) order.push_back(placed[k].second);
  }
  return order;
}

void join_crowd(const io::TriangleMesh& mesh, std::span<const MeshEdge> edge, Partners& partners) {
  std::vector<MeshEdge> left = round_the_edge(mesh, edge);
  for (bool found = true; found && left.size() > 1;) {
    found = false;
    for (std::size_t i = 0; i < left.size() && !found; ++i) {
      const std::size_t next = (i + 1) % left.size();
      if (left[i].forward || !left[next].forward) continue;
      join(partners, left[i], left[next]);
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(std::max(i, next)));
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(std::min(i, next)));
      found = true;
    }
  }
  for (std::size_t i = 0; i + 1 < left.size(); i += 2) join(partners, left[i], left[i + 1]);
}

double doubled_area(const io::TriangleMesh& mesh, std::uint32_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  const Vec3 p = mesh.positions_m[a];
  return norm(cross(mesh.positions_m[b] - p, mesh.positions_m[c] - p));
}

// The triangles of one piece from `first` on, and which of them face the other way than that.
void walk(const std::vector<char>& forward, const Partners& partners, std::uint32_t first, Surfaces& surfaces,
          std::vector<char>& turned, std::vector<std::uint32_t>& members) {
  members.assign(1, first);
  bool one_sided = false;
  surfaces.piece[first] = static_cast<std::uint32_t>(surfaces.pieces);
  for (std::size_t i = 0; i < members.size(); ++i)
    for (std::uint32_t c = 0; c < corners; ++c) {
      const std::uint32_t here = corners * members[i] + c, there = partners[here];
      if (there == nobody) continue;
      const std::uint32_t other = there / corners;
      const bool turn = (forward[here] == forward[there]) != (turned[members[i]] != 0);
      if (surfaces.piece[other] == nobody) {
        surfaces.piece[other] = surfaces.piece[first];
        turned[other] = turn ? 1 : 0;
        members.push_back(other);
      } else if ((turned[other] != 0) != turn) {
        one_sided = true;
      }
    }
  surfaces.one_sided += one_sided;
  ++surfaces.pieces;
}

void face_one_way(io::TriangleMesh& mesh, const std::vector<char>& forward, const Partners& partners,
                  Surfaces& surfaces) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  surfaces.piece.assign(count, nobody);
  std::vector<char> turned(count, 0);
  std::vector<std::uint32_t> members;
  for (std::uint32_t f = 0; f < count; ++f) {
    if (surfaces.piece[f] != nobody) continue;
    walk(forward, partners, f, surfaces, turned, members);
    double all = 0, other = 0;
    for (const std::uint32_t m : members) {
      const double area = doubled_area(mesh, m);
      all += area;
      other += turned[m] != 0 ? area : 0;
    }
    const char wrong = other > 0.5 * all ? 0 : 1;
    for (const std::uint32_t m : members) {
      turned[m] = turned[m] == wrong ? 1 : 0;
      surfaces.turned += turned[m] != 0;
    }
  }
  // Corners 1 and 2 change places.
  for (std::uint32_t f = 0; f < count; ++f)
    if (turned[f] != 0) std::swap(mesh.triangles[f][1], mesh.triangles[f][2]);
}

// One vertex for all corners that are joined over edges.
void split_fans(io::TriangleMesh& mesh, const std::vector<Corners>& before, const Partners& partners,
                Surfaces& surfaces) {
  UnionFind fans(corners * before.size());
  for (std::uint32_t here = 0; here < partners.size(); ++here) {
    const std::uint32_t there = partners[here];
    if (there == nobody || there < here) continue;
    const std::uint32_t f = here / corners, g = there / corners;
    const std::uint32_t a = here % corners, b = (a + 1) % corners, c = there % corners, d = (c + 1) % corners;
    const bool same = before[f][a] == before[g][c];
    fans.join(corners * f + a, corners * g + (same ? c : d));
    fans.join(corners * f + b, corners * g + (same ? d : c));
  }
  std::vector<std::uint32_t> number(partners.size(), nobody);
  std::vector<char> used(mesh.positions_m.size(), 0);
  std::vector<Vec3> positions;
  std::size_t places = 0;
  std::vector<Corners> split = before;
  for (std::uint32_t f = 0; f < before.size(); ++f)
    for (std::uint32_t c = 0; c < corners; ++c) {
      const std::uint32_t fan = fans.group(corners * f + c), old = before[f][c];
      if (number[fan] == nobody) {
        number[fan] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(mesh.positions_m[old]);
        places += used[old] == 0;
        used[old] = 1;
      }
      split[f][c] = number[fan];
    }
  surfaces.split_vertices = positions.size() - places;
  for (std::size_t f = 0; f < split.size(); ++f)
    if (mesh.triangles[f][1] != before[f][1]) std::swap(split[f][1], split[f][2]);
  mesh.triangles = std::move(split);
  mesh.positions_m = std::move(positions);
}

}  // namespace

std::vector<MeshEdge> edges_of(const std::vector<Corners>& triangles) {
  std::vector<MeshEdge> edges;
  edges.reserve(corners * triangles.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    for (std::uint32_t c = 0; c < corners; ++c) {
      const std::uint32_t from = triangles[f][c], to = triangles[f][(c + 1) % corners];
      edges.push_back({std::min(from, to), std::max(from, to), f, c, from < to});
    }
  std::sort(edges.begin(), edges.end(), [](const MeshEdge& a, const MeshEdge& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.face < b.face;
  });
  return edges;
}

Surfaces make_surfaces(io::TriangleMesh& mesh) {
  Surfaces surfaces;
  const std::vector<Corners> before = mesh.triangles;
  Partners partners(corners * before.size(), nobody);
  std::vector<char> forward(partners.size(), 0);
  const std::vector<MeshEdge> edges = edges_of(before);
  for (const MeshEdge& e : edges) forward[corners * e.face + e.corner] = e.forward ? 1 : 0;
  for_each_edge(edges, [&](std::span<const MeshEdge> edge) {
    surfaces.crowded += edge.size() > 2;
    if (edge.size() == 2)
      join(partners, edge[0], edge[1]);
    else if (edge.size() > 2)
      join_crowd(mesh, edge, partners);
  });
  face_one_way(mesh, forward, partners, surfaces);
  split_fans(mesh, before, partners, surfaces);
  return surfaces;
}

std::vector<std::uint32_t> pieces_of(const io::TriangleMesh& mesh, std::size_t& count) {
  UnionFind vertices(mesh.positions_m.size());
  for (const auto& [a, b, c] : mesh.triangles) vertices.join(a, b), vertices.join(b, c);
  std::vector<std::uint32_t> number(mesh.positions_m.size(), nobody), piece;
  count = 0;
  for (const Corners& t : mesh.triangles) {
    std::uint32_t& n = number[vertices.group(t[0])];
    if (n == nobody) n = static_cast<std::uint32_t>(count++);
    piece.push_back(n);
  }
  return piece;
}

}  // namespace gonio::mesh
