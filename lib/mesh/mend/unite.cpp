// See unite.h. Parts that hang together over edges of two triangles have one winding number before them and one behind
// them. At the middle of one of their triangles all other triangles fill a solid angle of 4 pi w; the n triangles that
// cover it, each counted with its sense, add n / 2 behind and take n / 2 away before.
#include "mesh/mend/unite.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/union_find.h"
#include "mesh/inside.h"
#include "mesh/mend/arrangement.h"
#include "mesh/mend/edges.h"
#include "mesh/unused_vertices.h"

namespace gonio::mesh {
namespace {

enum class Fate : char { goes, stays, turns };

Vec3 doubled_normal(const std::vector<Vec3>& p, const Corners& t) {
  return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
}

// Of every triangle the one with the most area in its patch.
std::vector<std::uint32_t> samples_of(const Arrangement& parts) {
  UnionFind patches(parts.triangles.size());
  for_each_edge(edges_of(parts.triangles), [&](std::span<const MeshEdge> edge) {
    if (edge.size() == 2) patches.join(edge[0].face, edge[1].face);
  });
  std::vector<std::uint32_t> largest(parts.triangles.size(), nobody);
  std::vector<double> area(parts.triangles.size(), -1);
  for (std::uint32_t f = 0; f < parts.triangles.size(); ++f) {
    const std::uint32_t patch = patches.group(f);
    const double own = norm(doubled_normal(parts.positions_m, parts.triangles[f]));
    if (own > area[patch]) area[patch] = own, largest[patch] = f;
  }
  std::vector<std::uint32_t> samples;
  for (std::uint32_t f = 0; f < parts.triangles.size(); ++f) samples.push_back(largest[patches.group(f)]);
  return samples;
}

Fate fate_of(const Mesh& whole, const Arrangement& parts, std::uint32_t sample) {
  const auto& [a, b, c] = parts.triangles[sample];
  const Vec3 centre = (parts.positions_m[a] + parts.positions_m[b] + parts.positions_m[c]) / 3;
  const std::uint32_t parent = parts.parent[sample];
  std::vector<std::uint32_t> covering = parts.covering[sample];
  if (covering.empty()) covering.push_back(parent);
  if (covering[0] != parent) return Fate::goes;  // the first of those that lie on each other speaks for all
  const Vec3 normal = doubled_normal(whole.positions_m, whole.triangles[parent]);
  double senses = 0;
  Mesh other;  // the covering ones, to be taken off again
  other.positions_m = whole.positions_m;
  for (const std::uint32_t t : covering) {
    senses += dot(normal, doubled_normal(whole.positions_m, whole.triangles[t])) > 0 ? 1 : -1;
    other.triangles.push_back(whole.triangles[t]);
  }
  const double rest = winding_number(whole, centre) - winding_number(other, centre);
  const bool before = std::round(rest - senses / 2) > 0, behind = std::round(rest + senses / 2) > 0;
  if (before == behind) return Fate::goes;
  return behind ? Fate::stays : Fate::turns;
}

}  // namespace

United unite(io::TriangleMesh& mesh) {
  United united;
  Arrangement parts = arrange(mesh);
  united.crossings = parts.crossings, united.cut_triangles = parts.cut;
  united.given_up = !parts.complete;
  if (united.given_up) return united;
  std::size_t pieces = 0;
  const std::vector<std::uint32_t> piece = pieces_of(mesh, pieces);
  if (parts.crossings == 0 && pieces == 1) return united;
  const std::vector<std::uint32_t> samples = samples_of(parts);
  std::vector<std::uint32_t> asked = samples;
  std::sort(asked.begin(), asked.end());
  asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
  Mesh whole;
  whole.positions_m = mesh.positions_m, whole.triangles = mesh.triangles;
  std::vector<Fate> fates(parts.triangles.size(), Fate::goes);
  parallel_for(0, asked.size(), [&](std::size_t i) { fates[asked[i]] = fate_of(whole, parts, asked[i]); });
  std::vector<char> seen(pieces, 0);
  mesh.positions_m = std::move(parts.positions_m);
  mesh.triangles.clear();
  for (std::uint32_t f = 0; f < samples.size(); ++f) {
    const Fate fate = fates[samples[f]];
    if (fate == Fate::goes) continue;
    seen[piece[parts.parent[f]]] = 1;
    Corners t = parts.triangles[f];
    if (fate == Fate::turns) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }
  united.within = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 0));
  drop_unused(mesh);
  return united;
}

}  // namespace gonio::mesh
