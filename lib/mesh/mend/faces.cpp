// See faces.h.
#include "mesh/mend/faces.h"

#include <algorithm>
#include <cmath>
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
  bool sheet() const { return forward == backward; }  // on its own reverse
};

// The same corners from the lowest on; whether they are passed in ascending order.
std::pair<Corners, bool> in_order(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  const bool forward = t[1] < t[2];
  if (!forward) std::swap(t[1], t[2]);
  return {t, forward};
}

// Sheets that hang together over edges where nothing else is. One on which others stand, or that is alone, has no part
// in what others enclose; all other triangles on their own reverse stand in for a triangle of a surface.
std::vector<bool> sheets_in_vain(const std::vector<std::pair<Corners, Copies>>& groups) {
  std::vector<Corners> different;
  for (const auto& group : groups) different.push_back(group.first);
  const auto is_sheet = [&](const MeshEdge& e) { return groups[e.face].second.sheet(); };
  const std::vector<MeshEdge> edges = edges_of(different);
  UnionFind sheets(groups.size());
  for_each_edge(edges, [&](std::span<const MeshEdge> edge) {
    if (edge.size() == 2 && is_sheet(edge[0]) && is_sheet(edge[1])) sheets.join(edge[0].face, edge[1].face);
  });
  std::vector<bool> crowded(groups.size(), false), alone(groups.size(), true), in_vain(groups.size(), false);
  for_each_edge(edges, [&](std::span<const MeshEdge> edge) {
    for (const MeshEdge& e : edge) {
      if (edge.size() > 2) crowded[sheets.group(e.face)] = true;
      if (edge.size() == 2 && is_sheet(edge[0]) != is_sheet(edge[1])) alone[sheets.group(e.face)] = false;
    }
  });
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const std::uint32_t sheet = sheets.group(g);
    in_vain[g] = groups[g].second.sheet() && (crowded[sheet] || alone[sheet]);
  }
  return in_vain;
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
  const std::vector<std::pair<Corners, Copies>> groups(found.begin(), found.end());
  const std::vector<bool> in_vain = sheets_in_vain(groups);
  std::vector<char> gone(mesh.triangles.size(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Copies& copies = groups[g].second;
    const bool wanted_forward = copies.forward >= copies.backward;
    bool kept = false;
    for (const std::uint32_t f : copies.faces) {
      const bool keep = !in_vain[g] && !kept && in_order(mesh.triangles[f]).second == wanted_forward;
      kept = kept || keep;
      gone[f] = keep ? 0 : 1;
    }
    (in_vain[g] ? report.cancelled : report.doubled) += copies.faces.size() - (in_vain[g] ? 0 : 1);
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

CleanedFaces clean_faces(io::TriangleMesh& mesh) {
  CleanedFaces report;
  mesh.normals.clear(), mesh.texture.clear(), mesh.properties.clear(), mesh.labels.clear();
  drop_unused(mesh);
  const std::vector<std::uint32_t> same = welded(mesh.positions_m);
  for (std::uint32_t v = 0; v < same.size(); ++v) report.merged_vertices += same[v] != v;
  for (Corners& t : mesh.triangles)
    for (std::uint32_t& v : t) v = same[v];
  report.collapsed = std::erase_if(mesh.triangles, is_collapsed);
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
