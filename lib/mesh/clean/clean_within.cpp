// Twice: local surfaces at every triangle from the data (bandwidth.h), their normals then being the guide for which
// edges are the object's. A vertex goes where the local surfaces of its triangles agree best:
//   x = argmin sum_f w_f (m_f . (x - p_f))^2 + epsilon sum_f w_f |x - data|^2      w_f = 1 / variance of the height
// p_f, m_f the point and normal of f's surface beside the vertex: on smooth ground their mean along the normal, at an
// edge the intersection of both sides. Always from the data, never from what an earlier pass made: nothing shrinks.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "linear/solve.h"
#include "mesh/clean.h"
#include "mesh/clean/bandwidth.h"
#include "mesh/clean/local_quadratic.h"
#include "mesh/mesh.h"
#include "mesh/verdict.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr double hold_tangentially = 0.01;  // epsilon
constexpr int guiding_rounds = 12;
constexpr double guiding_width_rad = 0.45;
constexpr std::size_t most_noise_faces = 20000;

double doubled_area_of(const NoisySurface& surface, std::size_t f) {
  const auto& [a, b, c] = surface.triangles[f];
  const Vec3 p = surface.positions_m[a];
  return norm(cross(surface.positions_m[b] - p, surface.positions_m[c] - p));
}

// A first guide: normals averaged with those of neighbours that do not differ by much (Zheng et al. 2011), weighted by
// area.
void guide_by_neighbours(NoisySurface& surface) {
  std::vector<double> area(surface.triangles.size());
  for (std::size_t f = 0; f < area.size(); ++f) area[f] = doubled_area_of(surface, f);
  std::vector<Vec3> guide(area.size()), next(area.size());
  for (std::size_t f = 0; f < area.size(); ++f) guide[f] = surface.faces[f].guide;
  for (int round = 0; round < guiding_rounds; ++round) {
    parallel_for(
        0, area.size(),
        [&](std::size_t f) {
          const Vec3 own = guide[f];
          Vec3 sum = own * area[f];
          for (const std::uint32_t other : surface.faces[f].behind) {
            if (other == nobody) continue;
            const Vec3 there = guide[other], gap = there - own;
            const double weight = std::exp(-dot(gap, gap) / (2 * guiding_width_rad * guiding_width_rad));
            sum += there * (weight * area[other]);
          }
          next[f] = norm(sum) > 0 ? normalized(sum) : own;
        },
        4096);
    guide.swap(next);
  }
  for (std::size_t f = 0; f < area.size(); ++f) surface.faces[f].guide = guide[f];
}

Vec3 own_normal(const NoisySurface& surface, std::size_t f) {
  const auto& [a, b, c] = surface.triangles[f];
  const Vec3 p = surface.positions_m[a], n = cross(surface.positions_m[b] - p, surface.positions_m[c] - p);
  return norm(n) > 0 ? normalized(n) : Vec3{0, 0, 1};
}

// normal_noise_rad() of a surface that is guided already.
double noise_of_normals(const NoisySurface& surface) {
  const std::size_t count = surface.faces.size(), step = std::max<std::size_t>(1, count / most_noise_faces);
  std::vector<double> angles((count + step - 1) / step, -1);
  constexpr std::size_t block = 256;
  parallel_for(0, (angles.size() + block - 1) / block, [&](std::size_t b) {
    Neighbourhood around(surface);
    for (std::size_t i = b * block; i < std::min(angles.size(), (b + 1) * block); ++i) {
      const auto f = static_cast<std::uint32_t>(i * step);
      around.start(f);
      around.grow(3 * surface.edge_m);
      const Basis basis(surface.faces[f].guide);
      LocalQuadratic quadratic;
      for (const std::uint32_t v : around.vertices()) {
        const Vec3 at = basis.to_local(surface.positions_m[v] - surface.faces[f].centroid) / surface.edge_m;
        quadratic.add(at.x, at.y, at.z);
      }
      const auto fit = quadratic.fit();
      if (!fit.good || quadratic.points() < 10) continue;
      const Vec3 n = basis.to_world(normalized(Vec3{-fit.c[1], -fit.c[2], 1}));
      const Vec3 own = own_normal(surface, f);
      angles[i] = std::atan2(norm(cross(n, own)), dot(n, own));
    }
  });
  std::erase_if(angles, [](double a) { return a < 0; });
  if (angles.empty()) return 0;
  std::sort(angles.begin(), angles.end());
  // An angle of two normal components has the median 1.177 sd each, 0.8326 of its rms.
  const double limit = 4 * angles[angles.size() / 2] / 1.1774;
  double squares = 0, n = 0;
  for (const double a : angles)
    if (a <= limit || limit == 0) {
      squares += a * a;
      ++n;
    }
  return std::sqrt(squares / n);
}

// The surface that a triangle shows beside p; its own plane where nothing was fitted.
SurfacePoint shown_at(const NoisySurface& surface, const std::vector<LocalSurface>& local, std::uint32_t f, Vec3 p) {
  if (local[f].radius > 0) return over(surface, local[f], f, p);
  return {p, surface.faces[f].guide};
}

void guide_by_surfaces(NoisySurface& surface, const std::vector<LocalSurface>& local) {
  parallel_for(
      0, local.size(),
      [&](std::size_t i) {
        const auto f = static_cast<std::uint32_t>(i);  // its own guide is all that a face's surface is told by
        surface.faces[f].guide = shown_at(surface, local, f, surface.faces[f].centroid).normal;
      },
      4096);
}

struct Placed {
  Vec3 position{}, normal{};
};

Placed placed(const NoisySurface& surface, const std::vector<LocalSurface>& local, std::span<const std::uint32_t> faces,
              std::uint32_t v) {
  using Three = Eigen::Matrix<double, 3, 3>;
  using Column = Eigen::Matrix<double, 3, 1>;
  const Vec3 data = surface.positions_m[v];
  Three a = Three::Zero();
  Column right = Column::Zero();
  double weights = 0;
  Vec3 normals{};
  for (const std::uint32_t f : faces) {
    const SurfacePoint shown = shown_at(surface, local, f, data);
    const double weight = local[f].variance > 0 ? 1 / static_cast<double>(local[f].variance) : 1;
    const Column m(shown.normal.x, shown.normal.y, shown.normal.z);
    a += weight * m * m.transpose();
    right += weight * dot(shown.normal, shown.point - data) * m;
    weights += weight;
    normals += shown.normal * (weight * doubled_area_of(surface, f));
  }
  if (!(weights > 0)) return {data, {0, 0, 1}};
  a.diagonal().array() += hold_tangentially * weights;
  const Column move = linear::solve_ldlt(a, right);
  return {data + Vec3{move[0], move[1], move[2]},
          norm(normals) > 0 ? normalized(normals) : surface.faces[faces[0]].guide};
}

// Where triangles meet that did not in the data, what moved goes back, and what is beside it, until none does.
std::size_t undo_intersections(io::TriangleMesh& mesh, const std::vector<Vec3>& data) {
  std::size_t undone = 0;
  for (int round = 0; round < 50; ++round) {
    const auto found = self_intersections(mesh, 1 << 20);
    std::size_t back = 0;
    for (const auto& [a, b] : found)
      for (const std::uint32_t f : {a, b})
        for (const std::uint32_t v : mesh.triangles[f])
          if (!(mesh.positions_m[v] == data[v])) {
            mesh.positions_m[v] = data[v];
            ++back;
          }
    undone += back;
    if (back == 0) break;
  }
  return undone;
}

std::vector<double> weights_of(const BoundedWish& wish, std::size_t vertices) {
  if (wish.sigma_m.empty()) return {};
  if (wish.sigma_m.size() != vertices)
    throw Error(Exit::internal, "mesh",
                std::to_string(wish.sigma_m.size()) + " uncertainties for " + std::to_string(vertices) + " vertices");
  const double middle = stats::median(wish.sigma_m);
  std::vector<double> weights;
  weights.reserve(vertices);
  for (const double sigma : wish.sigma_m) {
    const double ratio = sigma > 0 ? middle / sigma : 1;
    weights.push_back(std::clamp(ratio * ratio, 1e-4, 1e4));
  }
  return weights;
}

void move_vertices(io::TriangleMesh& mesh, const NoisySurface& surface, const std::vector<LocalSurface>& local,
                   const std::vector<Vec3>& data, double within_m) {
  const VertexFaces around = faces_of_vertices(mesh.triangles, data.size());
  mesh.normals.assign(data.size(), Vec3{0, 0, 1});
  parallel_for(
      0, data.size(),
      [&](std::size_t i) {
        const auto v = static_cast<std::uint32_t>(i);
        if (around.of(v).empty()) return;
        const Placed wanted = placed(surface, local, around.of(v), v);
        const Vec3 move = wanted.position - data[i];
        const double length = norm(move), most = within_m * (1 - 1e-9);
        mesh.positions_m[i] = length > most ? data[i] + move * (most / length) : wanted.position;
        mesh.normals[i] = wanted.normal;
      },
      1024);
}

}  // namespace

BoundedResult clean_within(io::TriangleMesh& mesh, const BoundedWish& wish) {
  if (!(wish.within_m >= 0)) throw Error(Exit::usage, "mesh", "a bound on the distance must not be negative");
  BoundedResult result;
  const std::vector<Vec3> data = mesh.positions_m;
  const std::vector<double> weights = weights_of(wish, data.size());
  const StatedNoise stated{wish.alike_m > 0 && !wish.sigma_m.empty() ? stats::median(wish.sigma_m) : 0, wish.alike_m};
  NoisySurface surface(data, mesh.triangles);
  guide_by_neighbours(surface);
  result.normal_noise_before_rad = noise_of_normals(surface);
  std::vector<LocalSurface> local;
  for (result.rounds = 0; result.rounds < wish.rounds; ++result.rounds) {
    if (result.rounds > 0) guide_by_surfaces(surface, local);
    result.sharp_edges = mark_sharp(surface, wish.feature_angle_rad);
    const VertexNoise noise = noise_of(surface, weights, stated);
    result.sigma_m = noise.sigma_m;
    result.inflation = noise.inflation();
    local = local_surfaces(surface, noise, weights);
  }
  for (const LocalSurface& one : local) result.mean_radius_m += one.radius * surface.edge_m;
  if (!local.empty()) result.mean_radius_m /= static_cast<double>(local.size());
  if (!local.empty()) move_vertices(mesh, surface, local, data, wish.within_m);
  result.undone = undo_intersections(mesh, data);
  double squares = 0;
  for (std::size_t v = 0; v < data.size(); ++v) {
    const double move = norm(mesh.positions_m[v] - data[v]);
    squares += move * move;
    result.largest_move_m = std::max(result.largest_move_m, move);
    result.at_bound += move > 0 && move >= wish.within_m * (1 - 1e-6);
  }
  if (!data.empty()) result.rms_move_m = std::sqrt(squares / static_cast<double>(data.size()));
  result.normal_noise_after_rad = normal_noise_rad(mesh);
  return result;
}

double normal_noise_rad(const io::TriangleMesh& mesh) {
  NoisySurface surface(mesh.positions_m, mesh.triangles);
  guide_by_neighbours(surface);
  return noise_of_normals(surface);
}

}  // namespace gonio::mesh
