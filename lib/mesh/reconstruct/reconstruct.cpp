// The steps of both chains, in their order.
#include "mesh/reconstruct.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/mesh.h"
#include "mesh/reconstruct/deviation.h"
#include "mesh/reconstruct/envelope.h"
#include "mesh/reconstruct/oriented_points.h"
#include "mesh/reconstruct/screened_poisson.h"
#include "mesh/unused_vertices.h"

namespace gonio::mesh {
namespace {

constexpr double reach_spacings = 2;     // a surface ends this far from its last point
constexpr double margin_sigmas = 4;      // behind a place seen through, at least
constexpr double least_agreement = 0.5;  // cosine between a vertex' normal and that of the points about it
constexpr std::size_t at_once = 256;     // vertices of a chunk

enum class Fate : char { stays, sparse, seen_through, contradicting };

void cut(io::TriangleMesh& mesh, const std::vector<Fate>& fates, Reconstruction& made) {
  made.sparse += static_cast<std::size_t>(std::ranges::count(fates, Fate::sparse));
  made.seen_through += static_cast<std::size_t>(std::ranges::count(fates, Fate::seen_through));
  made.contradicting += static_cast<std::size_t>(std::ranges::count(fates, Fate::contradicting));
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return fates[v] != Fate::stays; });
  });
  drop_unused(mesh);
}

// Density: the sixth neighbour of a vertex, as that of a point.
void trim(io::TriangleMesh& mesh, const PointTree& tree, const PointSurface& surface, const ReconstructionWish& wish,
          Reconstruction& made) {
  std::vector<Fate> fates(mesh.positions_m.size(), Fate::stays);
  parallel_for(
      0, fates.size(),
      [&](std::size_t v) {
        std::vector<PointTree::Neighbour> near;
        tree.nearest(mesh.positions_m[v], 6, near);
        bool far = std::sqrt(near.back().squared) > wish.trim * surface.spacing_m();
        if (wish.chain == Chain::gonio) {
          const double own = std::max(surface.spacing_m(near.front().point), surface.spacing_m());
          far = far || std::sqrt(near.front().squared) > reach_spacings * own;
        }
        if (far) fates[v] = Fate::sparse;
      },
      at_once);
  cut(mesh, fates, made);
}

void clear_envelope(io::TriangleMesh& mesh, const MeasuredPoints& points, const PointTree& tree,
                    const PointSurface& surface, Reconstruction& made) {
  const Envelope envelope(points);
  std::vector<Fate> fates(mesh.positions_m.size(), Fate::stays);
  parallel_for(
      0, fates.size(),
      [&](std::size_t v) {
        const Vec3 at = mesh.positions_m[v];
        std::vector<PointTree::Neighbour> near;
        tree.nearest(at, 1, near);
        const std::uint32_t point = near.front().point;
        const double variance = surface.variance_m2(point, surface.towards_camera(point));
        const double margin = margin_sigmas * surface.noise_ratio() * std::sqrt(variance) + 2 * surface.spacing_m();
        if (envelope.seen_through(at, margin)) fates[v] = Fate::seen_through;
      },
      at_once);
  cut(mesh, fates, made);
}

// Poisson closes what is open: at the rim of a trimmed sheet a strip turns off towards nothing, and contradicts the
// points from the rim inwards. Within the sheet a vertex that contradicts them is no reason for a hole.
void mark_turned_rims(const io::TriangleMesh& mesh, const std::vector<char>& doubtful, std::vector<Fate>& fates) {
  const std::vector<char> rim = rim_vertices(mesh.triangles, mesh.positions_m.size());
  const VertexFaces around = faces_of_vertices(mesh.triangles, mesh.positions_m.size());
  std::vector<std::uint32_t> open;
  for (std::uint32_t v = 0; v < rim.size(); ++v)
    if (rim[v] != 0) open.push_back(v);
  while (!open.empty()) {
    const std::uint32_t v = open.back();
    open.pop_back();
    for (const std::uint32_t t : around.of(v))
      for (const std::uint32_t next : mesh.triangles[t])
        if (doubtful[next] != 0 && fates[next] == Fate::stays) fates[next] = Fate::contradicting, open.push_back(next);
  }
}

// What the points about each vertex say: where it is (ours), and how well that is known.
void fit_vertices(io::TriangleMesh& mesh, const PointSurface& surface, Chain chain, Reconstruction& made) {
  const std::vector<Vec3> normals = averaged_normals(mesh.positions_m, mesh.triangles);
  std::vector<PointFit> fits(normals.size());
  parallel_for(
      0, fits.size(), [&](std::size_t v) { fits[v] = surface.fit(mesh.positions_m[v], normals[v]); }, at_once);
  std::vector<char> doubtful(fits.size(), 0);
  std::vector<Fate> fates(fits.size(), Fate::stays);
  mesh.normals = normals;
  mesh.properties.assign(1, std::vector<float>(fits.size()));
  for (std::size_t v = 0; v < fits.size(); ++v) {
    const PointFit& fit = fits[v];
    const double off = norm(fit.point - mesh.positions_m[v]);
    doubtful[v] = !fit.good || dot(fit.normal, normals[v]) < least_agreement || fit.leverage > 1 ||
                  off > margin_sigmas * fit.point_sigma_m + reach_spacings * surface.spacing_m();
    if (chain == Chain::gonio && doubtful[v] == 0) {
      mesh.positions_m[v] = fit.point, mesh.normals[v] = fit.normal;
      mesh.properties[0][v] = static_cast<float>(fit.sigma_m);
    } else if (doubtful[v] != 0) {  // it stays where it is, known no better than one point about it
      mesh.properties[0][v] = static_cast<float>(fit.good ? fit.point_sigma_m : surface.spacing_m());
    } else {  // it stays where it is, and is known to be off by as much
      mesh.properties[0][v] = static_cast<float>(std::hypot(fit.sigma_m, off));
    }
  }
  if (chain == Chain::gonio) mark_turned_rims(mesh, doubtful, fates);
  cut(mesh, fates, made);
}

double area_of(const io::TriangleMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return 0.5 * norm(cross(mesh.positions_m[b] - mesh.positions_m[a], mesh.positions_m[c] - mesh.positions_m[a]));
}

void part(io::TriangleMesh& mesh, double least_share, Reconstruction& made) {
  UnionFind parts(mesh.positions_m.size());
  for (const auto& t : mesh.triangles) parts.join(t[0], t[1]), parts.join(t[0], t[2]);
  std::vector<MeshComponent> of_group(mesh.positions_m.size());
  for (std::uint32_t v = 0; v < mesh.positions_m.size(); ++v) ++of_group[parts.group(v)].vertices;
  double largest = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    MeshComponent& own = of_group[parts.group(mesh.triangles[t][0])];
    ++own.triangles, own.area_m2 += area_of(mesh, t);
    largest = std::max(largest, own.area_m2);
  }
  const auto kept = [&](const MeshComponent& c) { return c.triangles > 0 && c.area_m2 >= least_share * largest; };
  for (const MeshComponent& c : of_group) {
    if (kept(c)) made.components.push_back(c);
    if (c.triangles > 0 && !kept(c)) ++made.dropped_components, made.dropped_triangles += c.triangles;
  }
  std::ranges::stable_sort(made.components, std::greater<>{}, &MeshComponent::area_m2);
  std::erase_if(mesh.triangles, [&](const auto& t) { return !kept(of_group[parts.group(t[0])]); });
  drop_unused(mesh);
}

// Inversely as the squared distance from the nearest points.
std::vector<std::array<float, 3>> colours_of(const io::TriangleMesh& mesh, const MeasuredPoints& points,
                                             const PointTree& tree) {
  std::vector<std::array<float, 3>> colours(points.colour.empty() ? 0 : mesh.positions_m.size());
  parallel_for(
      0, colours.size(),
      [&](std::size_t v) {
        std::vector<PointTree::Neighbour> near;
        tree.nearest(mesh.positions_m[v], 8, near);
        double sum = 0;
        std::array<double, 3> colour{};
        for (const PointTree::Neighbour& m : near) {
          const double weight = 1 / (m.squared + 1e-3 * near.back().squared + 1e-300);
          sum += weight;
          for (std::size_t k = 0; k < 3; ++k) colour[k] += weight * points.colour[m.point][k];
        }
        for (std::size_t k = 0; k < 3; ++k) colours[v][k] = static_cast<float>(colour[k] / sum);
      },
      at_once);
  return colours;
}

}  // namespace

Reconstruction reconstruct(const MeasuredPoints& points, const ReconstructionWish& wish) {
  const PointTree tree(points.positions_m);
  const PointSurface surface(points, tree);
  Reconstruction made;
  made.spacing_m = surface.spacing_m(), made.noise_ratio = surface.noise_ratio();
  const OrientedPoints oriented =
      wish.chain == Chain::thesis ? oriented_by_planes(points, wish) : oriented_by_surface(tree, surface, wish);
  io::TriangleMesh mesh = screened_poisson(oriented.positions_m, oriented.normals, wish.depth, oriented.by_length);
  made.poisson_vertices = mesh.positions_m.size();
  trim(mesh, tree, surface, wish, made);
  if (wish.chain == Chain::gonio) clear_envelope(mesh, points, tree, surface, made);
  fit_vertices(mesh, surface, wish.chain, made);
  part(mesh, wish.least_share, made);
  made.sigma_m = std::move(mesh.properties[0]);
  mesh.properties.clear();
  made.colour = colours_of(mesh, points, tree);
  deviate(points, surface, mesh, made);
  made.mesh = std::move(mesh);
  return made;
}

}  // namespace gonio::mesh
