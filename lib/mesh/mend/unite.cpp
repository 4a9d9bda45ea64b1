// See unite.h. Parts that hang together over edges of two triangles have one winding number before them and one behind
// them.
#include "mesh/mend/unite.h"

#include <algorithm>

#include "base/union_find.h"
#include "mesh/mend/arrangement.h"
#include "mesh/mend/edges.h"
#include "mesh/mend/faces.h"

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

Fate fate_of(const io::TriangleMesh& whole, const Arrangement& parts, std::uint32_t sample) {
  const std::vector<std::uint32_t>& covering = parts.covering[sample];
  // The first of those that lie on each other speaks for all.
  if (!covering.empty() && covering[0] != parts.parent[sample]) return Fate::goes;
  const auto [before, behind] = windings(whole, parts, sample);
  if ((before > 0) == (behind > 0)) return Fate::goes;
  return behind > 0 ? Fate::stays : Fate::turns;
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
  std::vector<Fate> fates(parts.triangles.size(), Fate::goes);
  for (const std::uint32_t sample : asked) fates[sample] = fate_of(mesh, parts, sample);
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
  merge_places(mesh);  // exact places that are one when rounded
  return united;
}

}  // namespace gonio::mesh
