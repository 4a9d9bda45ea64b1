// See faces.h.
#include "mesh/mend/faces.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/mend/edges.h"
#include "mesh/topology.h"
#include "mesh/unused_vertices.h"

namespace gonio::mesh {
namespace {

constexpr double line_share = 1e-10;  // height over length of a triangle that is a line
constexpr int most_rounds = 8;

bool is_collapsed(const Corners& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// The corner c of a needle before whose longest edge, c to c + 1, the third one stands; 3: no needle.
std::size_t needle_edge(const io::TriangleMesh& mesh, const Corners& t) {
  std::array<double, 3> length{};
  for (std::size_t c = 0; c < 3; ++c) length[c] = norm(mesh.positions_m[t[(c + 1) % 3]] - mesh.positions_m[t[c]]);
  const auto longest = static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
  const Vec3 a = mesh.positions_m[t[0]];
  const double area = norm(cross(mesh.positions_m[t[1]] - a, mesh.positions_m[t[2]] - a));
  return area <= line_share * length[longest] * length[longest] ? longest : 3;
}

struct Copies {
  std::vector<std::uint32_t> faces;
  int forward = 0, backward = 0;
  std::size_t net() const { return static_cast<std::size_t>(std::abs(forward - backward)); }
};
using CopyGroups = std::vector<std::pair<Corners, Copies>>;

// The same corners from the lowest on; whether they are passed in ascending order.
std::pair<Corners, bool> in_order(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  const bool forward = t[1] < t[2];
  if (!forward) std::swap(t[1], t[2]);
  return {t, forward};
}

// How many copies of each triangle stay. Triangles with as many copies that hang together over edges where nothing else
// is are one patch, and what is beside it decides: one other triangle at its border makes it part of a surface, two the
// common side of two bodies. There a patch on its own reverse goes, and one that all copies face alike stays twice.
std::vector<std::size_t> copies_to_keep(const CopyGroups& groups) {
  std::vector<Corners> different;
  for (const auto& group : groups) different.push_back(group.first);
  const auto copies = [&](const MeshEdge& e) -> const Copies& { return groups[e.face].second; };
  const std::vector<MeshEdge> edges = edges_of(different);
  UnionFind patches(groups.size());
  for_each_edge(edges, [&](std::span<const MeshEdge> edge) {
    if (edge.size() == 2 && copies(edge[0]).faces.size() == copies(edge[1]).faces.size() &&
        copies(edge[0]).net() == copies(edge[1]).net())
      patches.join(edge[0].face, edge[1].face);
  });
  constexpr std::size_t no_border = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> beside(groups.size(), no_border), keep(groups.size(), 1);
  for_each_edge(edges, [&](std::span<const MeshEdge> edge) {
    if (edge.size() == 2 && patches.group(edge[0].face) == patches.group(edge[1].face)) return;
    for (const MeshEdge& mine : edge) {
      std::size_t others = 0;
      const std::uint32_t patch = patches.group(mine.face);
      for (const MeshEdge& e : edge) others += patches.group(e.face) == patch ? 0 : copies(e).faces.size();
      if (others > 0) beside[patch] = std::min(beside[patch], others);  // 0: a hole, which says nothing
    }
  });
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const std::size_t others = beside[patches.group(g)], net = groups[g].second.net();
    if (groups[g].second.faces.size() == 1) continue;
    if (net == 0)
      keep[g] = others == no_border ? 0 : others % 2;
    else if (others != no_border)
      keep[g] = std::max<std::size_t>(1, std::min(net, others) - (std::min(net, others) - others) % 2);
  }
  return keep;
}

void drop_copies(io::TriangleMesh& mesh, CleanedFaces& report) {
  std::map<Corners, Copies> found;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto [t, forward] = in_order(mesh.triangles[f]);
    Copies& copies = found[t];
    copies.faces.push_back(f);
    ++(forward ? copies.forward : copies.backward);
  }
  if (found.size() == mesh.triangles.size()) return;
  const CopyGroups groups(found.begin(), found.end());
  const std::vector<std::size_t> keep = copies_to_keep(groups);
  std::vector<char> gone(mesh.triangles.size(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Copies& copies = groups[g].second;
    const bool wanted_forward = copies.forward >= copies.backward;
    std::size_t kept = 0;
    for (const std::uint32_t f : copies.faces) {
      const bool stays = kept < keep[g] && in_order(mesh.triangles[f]).second == wanted_forward;
      kept += stays;
      gone[f] = stays ? 0 : 1;
    }
    (keep[g] == 0 ? report.cancelled : report.doubled) += copies.faces.size() - kept;
  }
  std::size_t left = 0;
  for (std::size_t f = 0; f < gone.size(); ++f)
    if (gone[f] == 0) mesh.triangles[left++] = mesh.triangles[f];
  mesh.triangles.resize(left);
}

}  // namespace

// A needle abc, with c on the edge ab, goes, and its neighbour bad over that edge becomes bcd and cad. Rounds, because
// needles stand beside needles. What has no single neighbour stays: it has no area and harms nothing.
std::size_t turn_needles(io::TriangleMesh& mesh) {
  std::size_t turned = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<MeshEdge> edges = edges_of(mesh.triangles);
    std::vector<char> touched(mesh.triangles.size(), 0), gone(mesh.triangles.size(), 0);
    std::vector<Corners> added;
    for_each_edge(edges, [&](std::span<const MeshEdge> edge) {
      if (edge.size() != 2) return;
      for (std::size_t i = 0; i < 2; ++i) {
        const MeshEdge &mine = edge[i], &other = edge[1 - i];
        if (touched[mine.face] != 0 || touched[other.face] != 0) continue;
        if (needle_edge(mesh, mesh.triangles[mine.face]) != mine.corner) continue;
        const std::uint32_t c = mesh.triangles[mine.face][(mine.corner + 2) % 3];
        const Corners& t = mesh.triangles[other.face];
        const std::uint32_t from = t[other.corner], to = t[(other.corner + 1) % 3], d = t[(other.corner + 2) % 3];
        if (c == d || needle_edge(mesh, t) != 3) continue;
        touched[mine.face] = touched[other.face] = 1;
        gone[mine.face] = gone[other.face] = 1;
        added.push_back({from, c, d});
        added.push_back({c, to, d});
        ++turned;
        return;
      }
    });
    if (added.empty()) break;
    std::vector<Corners> kept;
    for (std::size_t f = 0; f < gone.size(); ++f)
      if (gone[f] == 0) kept.push_back(mesh.triangles[f]);
    kept.insert(kept.end(), added.begin(), added.end());
    mesh.triangles = std::move(kept);
  }
  return turned;
}

Merged merge_places(io::TriangleMesh& mesh) {
  Merged merged;
  drop_unused(mesh);
  const std::vector<std::uint32_t> same = welded(mesh.positions_m);
  for (std::uint32_t v = 0; v < same.size(); ++v) merged.vertices += same[v] != v;
  for (Corners& t : mesh.triangles)
    for (std::uint32_t& v : t) v = same[v];
  merged.collapsed = std::erase_if(mesh.triangles, is_collapsed);
  drop_unused(mesh);
  return merged;
}

CleanedFaces clean_faces(io::TriangleMesh& mesh) {
  CleanedFaces report;
  mesh.normals.clear(), mesh.texture.clear(), mesh.properties.clear(), mesh.labels.clear();
  const Merged merged = merge_places(mesh);
  report.merged_vertices = merged.vertices, report.collapsed = merged.collapsed;
  report.needles = turn_needles(mesh);
  drop_copies(mesh, report);
  drop_unused(mesh);
  return report;
}

std::size_t stitch_rims(io::TriangleMesh& mesh, double reach_m) {
  std::vector<char> rim(mesh.positions_m.size(), 0);
  std::set<std::pair<std::uint32_t, std::uint32_t>> joined;  // along an edge
  const std::vector<MeshEdge> edges = edges_of(mesh.triangles);
  for_each_edge(edges, [&](std::span<const MeshEdge> edge) {
    if (edge.size() % 2 == 1) rim[edge[0].low] = rim[edge[0].high] = 1;
  });
  for (const MeshEdge& edge : edges)
    if (rim[edge.low] != 0 && rim[edge.high] != 0) joined.insert({edge.low, edge.high});
  using Cell = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
  const auto cell_of = [&](Vec3 p) {
    return Cell{std::llround(p.x / reach_m), std::llround(p.y / reach_m), std::llround(p.z / reach_m)};
  };
  std::map<Cell, std::vector<std::uint32_t>> cells;
  std::vector<std::uint32_t> becomes(mesh.positions_m.size());
  std::size_t gone = 0;
  for (std::uint32_t v = 0; v < becomes.size(); ++v) {
    becomes[v] = v;
    if (rim[v] == 0) continue;
    const auto [x, y, z] = cell_of(mesh.positions_m[v]);
    for (int i = 0; i < 27 && becomes[v] == v; ++i) {
      const auto found = cells.find({x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1});
      if (found == cells.end()) continue;
      for (const std::uint32_t w : found->second)
        if (norm(mesh.positions_m[w] - mesh.positions_m[v]) <= reach_m && !joined.contains({w, v})) {
          becomes[v] = w;
          ++gone;
          break;
        }
    }
    if (becomes[v] == v) cells[{x, y, z}].push_back(v);
  }
  if (gone == 0) return 0;
  for (Corners& t : mesh.triangles)
    for (std::uint32_t& v : t) v = becomes[v];
  std::erase_if(mesh.triangles, is_collapsed);
  drop_unused(mesh);
  return gone;
}

double signed_volume_m3(const io::TriangleMesh& mesh) {
  double six = 0;
  if (mesh.positions_m.empty()) return 0;
  const Vec3 origin = mesh.positions_m[0];
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(mesh.positions_m[a] - origin, cross(mesh.positions_m[b] - origin, mesh.positions_m[c] - origin));
  return six / 6;
}

}  // namespace gonio::mesh
