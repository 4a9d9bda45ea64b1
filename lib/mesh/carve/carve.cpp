// One loop after the other: its plane, a band of the surface round it, a continuation of that band (continuation.h), a
// flat triangulation of the hole lifted onto it. What the rim has over the continuation (its noise) runs out over the
// fill as a harmonic function, so that the fill joins the rim where it is.
#include "mesh/carve.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "mesh/carve/continuation.h"
#include "mesh/carve/flat_triangulation.h"
#include "mesh/carve/opening.h"
#include "mesh/mesh.h"
#include "mesh/verdict.h"
#include "mesh/unused_vertices.h"

namespace gonio::mesh {
namespace {

constexpr double band_share = 0.8;      // of the hole's radius
constexpr double least_band_edges = 4;  // mean edges of the rim
constexpr double least_upright = 0.25;  // cosine between the band's normals and the plane's: a height, not a wall
constexpr int harmonic_sweeps = 400;

struct Rim {
  std::vector<std::uint32_t> loop;
  Vec3 centre{};
  Basis plane{Vec3{0, 0, 1}};
  double radius_m = 0, edge_m = 0, diameter_m = 0;
  Vec3 local(Vec3 p) const { return plane.to_local(p - centre); }
};

// The plane through the loop's centre; its normal the loop's area vector, which points outwards: new triangles pass the
// loop as old ones did.
Rim rim_of(const io::TriangleMesh& mesh, std::vector<std::uint32_t> loop) {
  Rim rim;
  Vec3 area{};
  for (const std::uint32_t v : loop) rim.centre += mesh.positions_m[v] / static_cast<double>(loop.size());
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = mesh.positions_m[loop[i]] - rim.centre,
               b = mesh.positions_m[loop[(i + 1) % loop.size()]] - rim.centre;
    area += cross(a, b);
    rim.edge_m += norm(b - a) / static_cast<double>(loop.size());
    rim.radius_m = std::max(rim.radius_m, norm(a));
    for (const std::uint32_t w : loop)
      rim.diameter_m = std::max(rim.diameter_m, norm(mesh.positions_m[w] - mesh.positions_m[loop[i]]));
  }
  if (norm(area) > 0) rim.plane = Basis(normalized(area));
  rim.loop = std::move(loop);
  return rim;
}

// The surface round the rim as heights: what is reached from it over triangles that stay and that are no wall.
std::vector<HeightSample> band_of(const io::TriangleMesh& mesh, const Neighbours& neighbours,
                                  const std::vector<bool>& out, const Rim& rim) {
  const double width = std::max(band_share * rim.radius_m, least_band_edges * rim.edge_m);
  std::map<std::uint32_t, std::uint32_t> number;  // of the vertices in the band
  std::vector<HeightSample> band;
  std::vector<std::uint32_t> queue;
  const auto take = [&](std::uint32_t v) {
    const auto [at, fresh] = number.try_emplace(v, static_cast<std::uint32_t>(band.size()));
    if (!fresh) return at->second;
    const Vec3 p = rim.local(mesh.positions_m[v]);
    band.push_back({p.x, p.y, p.z, {}});
    queue.push_back(v);
    return at->second;
  };
  for (const std::uint32_t v : rim.loop) take(v);
  std::map<std::uint32_t, bool> seen;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const Vec3 here = rim.local(mesh.positions_m[queue[i]]);
    if (norm(Vec2{here.x, here.y}) > rim.radius_m + width) continue;
    for (const std::uint32_t f : neighbours.around.of(queue[i])) {
      if (out[f] || !seen.try_emplace(f, true).second) continue;
      const auto& [a, b, c] = mesh.triangles[f];
      const Vec3 p = mesh.positions_m[a];
      const Vec3 n = cross(mesh.positions_m[b] - p, mesh.positions_m[c] - p);
      if (dot(n, rim.plane.n) < least_upright * norm(n)) continue;
      const std::array<std::uint32_t, 3> places{take(a), take(b), take(c)};
      for (std::size_t k = 0; k < 3; ++k) band[places[k]].beside.push_back(places[(k + 1) % 3]);
    }
  }
  return band;
}

// Values at the inner points that are the mean of their neighbours', given those at the rim.
std::vector<double> harmonic(const FlatTriangulation& flat, std::vector<double> rim) {
  const std::size_t fixed = rim.size();
  std::vector<std::vector<std::uint32_t>> beside(fixed + flat.inner.size());
  for (const auto& t : flat.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      beside[t[c]].push_back(t[(c + 1) % 3]);
      beside[t[c]].push_back(t[(c + 2) % 3]);
    }
  rim.resize(beside.size(), 0);
  for (int sweep = 0; sweep < harmonic_sweeps; ++sweep)
    for (std::size_t i = fixed; i < rim.size(); ++i) {
      double sum = 0;
      for (const std::uint32_t j : beside[i]) sum += rim[j];
      if (!beside[i].empty()) rim[i] = sum / static_cast<double>(beside[i].size());
    }
  return rim;
}

// What a vertex carries beside its place: the rim's mean.
void append_vertex(io::TriangleMesh& mesh, Vec3 position, Vec3 normal, const Rim& rim) {
  mesh.positions_m.push_back(position);
  if (!mesh.normals.empty()) mesh.normals.push_back(normal);
  const auto share = 1 / static_cast<double>(rim.loop.size());
  if (!mesh.texture.empty()) {
    Vec2 mean{};
    for (const std::uint32_t v : rim.loop) mean = mean + mesh.texture[v] * share;
    mesh.texture.push_back(mean);
  }
  for (auto& values : mesh.properties) {
    if (values.empty()) continue;
    double mean = 0;
    for (const std::uint32_t v : rim.loop) mean += static_cast<double>(values[v]) * share;
    values.push_back(static_cast<float>(mean));
  }
}

struct FillPlan {
  FilledHole hole{};
  Rim rim{};
  FlatTriangulation flat{};
  std::vector<Vec3> positions{}, normals{};  // of the inner points
};

// Nothing where the hole is no function over its plane.
std::optional<FillPlan> plan_fill(const io::TriangleMesh& mesh, const Neighbours& neighbours,
                                  const std::vector<bool>& out, Rim rim) {
  const std::vector<HeightSample> band = band_of(mesh, neighbours, out, rim);
  const Continuation surface(band, rim.radius_m);
  std::vector<Vec2> polygon;
  std::vector<double> over;
  for (const std::uint32_t v : rim.loop) {
    const Vec3 p = rim.local(mesh.positions_m[v]);
    polygon.push_back({p.x, p.y});
    over.push_back(p.z - surface.at(p.x, p.y));
  }
  FillPlan plan;
  plan.flat = flat_triangulation(polygon, rim.edge_m);
  if (plan.flat.triangles.empty()) return std::nullopt;
  over = harmonic(plan.flat, std::move(over));
  for (std::size_t i = 0; i < plan.flat.inner.size(); ++i) {
    const auto [u, v] = plan.flat.inner[i];
    const double h = surface.at(u, v) + over[polygon.size() + i];
    plan.positions.push_back(rim.centre + rim.plane.to_world({u, v, h}));
    plan.normals.push_back(rim.plane.to_world(surface.normal_at(u, v)));
  }
  plan.hole.rim_vertices = rim.loop.size();
  plan.hole.new_triangles = plan.flat.triangles.size();
  plan.hole.diameter_m = rim.diameter_m;
  plan.hole.depth_m = surface.at(0, 0);
  // In the middle the rim's own noise has come down to that of its mean.
  plan.hole.uncertainty_m =
      std::hypot(surface.sigma_at(0, 0), std::sqrt(surface.noise_variance() / static_cast<double>(rim.loop.size())));
  plan.hole.degree = static_cast<std::size_t>(surface.degree());
  plan.rim = std::move(rim);
  return plan;
}

std::string name_of(std::size_t sphere, const std::vector<CarvedSphere>& spheres) {
  const Vec3 c = spheres[sphere].centre_m;
  return "sphere " + std::to_string(sphere) + " at (" + std::to_string(c.x) + ", " + std::to_string(c.y) + ", " +
         std::to_string(c.z) + ") m";
}

std::size_t nearest_sphere(Vec3 p, const std::vector<CarvedSphere>& spheres) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const double gap = norm(p - spheres[s].centre_m) / spheres[s].radius_m;
    if (gap < least) {
      least = gap;
      nearest = s;
    }
  }
  return nearest;
}

// Triangles that stay, then the fills; vertices that nothing uses any more are dropped.
io::TriangleMesh assembled(const io::TriangleMesh& mesh, const std::vector<bool>& out,
                           const std::vector<FillPlan>& plans, std::size_t& first_new) {
  io::TriangleMesh all = mesh;
  all.triangles.clear();
  all.labels.clear();
  for (std::size_t f = 0; f < out.size(); ++f) {
    if (out[f]) continue;
    all.triangles.push_back(mesh.triangles[f]);
    if (!mesh.labels.empty()) all.labels.push_back(mesh.labels[f]);
  }
  first_new = all.triangles.size();
  for (const FillPlan& plan : plans) {
    const auto first = static_cast<std::uint32_t>(all.positions_m.size());
    const auto rim = static_cast<std::uint32_t>(plan.rim.loop.size());
    for (std::size_t i = 0; i < plan.positions.size(); ++i)
      append_vertex(all, plan.positions[i], plan.normals[i], plan.rim);
    for (const auto& t : plan.flat.triangles) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t c = 0; c < 3; ++c) corners[c] = t[c] < rim ? plan.rim.loop[t[c]] : first + t[c] - rim;
      all.triangles.push_back(corners);
      if (!mesh.labels.empty()) all.labels.push_back(0);
    }
  }
  return all;
}

}  // namespace

Carved carve(io::TriangleMesh& mesh, const std::vector<CarvedSphere>& spheres, double eps, const std::string& place) {
  Carved carved;
  const Neighbours neighbours(mesh);
  std::vector<bool> out(mesh.triangles.size(), false);
  std::size_t parts = parts_left(neighbours, out);
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const std::size_t taken = take_out(mesh, neighbours, spheres[s].centre_m, (1 + eps) * spheres[s].radius_m, out);
    if (taken == 0) {
      carved.untouched.push_back(s);
      continue;
    }
    carved.removed_triangles += taken;
    const std::size_t left = parts_left(neighbours, out);
    if (left > parts || left == 0)
      throw Error(Exit::data, place,
                  name_of(s, spheres) + (left == 0 ? " takes the whole mesh" : " would cut the mesh into parts") +
                      " (radius " + std::to_string((1 + eps) * spheres[s].radius_m) + " m with its margin)",
                  "take a smaller margin, or leave it out");
    parts = left;
  }
  std::vector<FillPlan> plans;
  for (auto& loop : opened_loops(mesh, neighbours, out)) {
    Rim rim = rim_of(mesh, std::move(loop));
    const std::size_t sphere = nearest_sphere(rim.centre, spheres);
    auto plan = plan_fill(mesh, neighbours, out, std::move(rim));
    if (!plan)
      throw Error(Exit::data, place,
                  "the hole left by " + name_of(sphere, spheres) +
                      " cannot be filled: it does not lie "
                      "over one plane",
                  "take a smaller margin");
    plan->hole.sphere = sphere;
    plans.push_back(std::move(*plan));
    carved.holes.push_back(plans.back().hole);
  }
  if (plans.empty()) return carved;
  std::size_t first_new = 0;
  io::TriangleMesh filled = assembled(mesh, out, plans, first_new);
  for (const auto& pair : self_intersections(filled, 1 << 20))
    if (pair.second >= first_new) {
      std::size_t at = pair.second - first_new, hole = 0;
      while (at >= plans[hole].flat.triangles.size()) at -= plans[hole++].flat.triangles.size();
      throw Error(Exit::data, place,
                  "the hole left by " + name_of(plans[hole].hole.sphere, spheres) +
                      " cannot be filled without meeting "
                      "the surface beside it",
                  "take a smaller margin");
    }
  drop_unused(filled);
  mesh = std::move(filled);
  return carved;
}

}  // namespace gonio::mesh
