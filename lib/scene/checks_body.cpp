// Bodies (scene/checks_body.h). Spheres and planes in closed form, meshes triangle by triangle (Moeller & Trumbore
// 1997 for rays).
#include "scene/checks_body.h"

#include <algorithm>
#include <cmath>

#include "mesh/inside.h"

namespace gonio::scene {
namespace {

bool meets_triangle(Vec3 o, Vec3 d, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 e = b - a, f = c - a, p = cross(d, f);
  const double det = dot(e, p);
  if (det == 0) return false;
  const Vec3 s = o - a, q = cross(s, e);
  const double u = dot(s, p) / det, v = dot(d, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && dot(f, q) / det > 0;
}

// Farther than `margin` from the box around it?
bool outside_box(const mesh::Mesh& mesh, Vec3 p, double margin) {
  bool low[3] = {true, true, true}, high[3] = {true, true, true};  // is everything above, below the point?
  for (const Vec3 v : mesh.positions_m)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = low[axis] && v[axis] > p[axis] + margin;
      high[axis] = high[axis] && v[axis] < p[axis] - margin;
    }
  return low[0] || low[1] || low[2] || high[0] || high[1] || high[2];
}

std::string counted(std::size_t n, const char* one, const char* several) {
  return std::to_string(n) + " " + (n == 1 ? one : several);
}

}  // namespace

std::string open_words(const mesh::Topology& topology) {
  if (topology.boundary_edges == 0)
    return "has " + counted(topology.disagreeing_edges, "edge", "edges") + " whose triangles face opposite ways";
  return "has " + counted(topology.boundary_edges, "open edge", "open edges") + " around " +
         counted(topology.holes, "hole", "holes");
}

const char* open_consequence() {
  return "light that enters never leaves again or leaves unseen, and what is absorbed inside is wrong";
}

Body::Body(const Instance& instance, const Surface& surface) : instance_(instance) {
  if (const auto* shared = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape)) mesh_ = shared->get();
  transmits_ = surface.model->transmits();
  scatters_beneath_ = surface.model->subsurface(surface.values) != nullptr;
}

const mesh::Topology& Body::topology() const {
  if (!topology_) topology_ = std::make_unique<mesh::Topology>(mesh::topology_of(*mesh_));
  return *topology_;
}

bool Body::closed() const {
  return mesh_ ? topology().closed() : std::holds_alternative<Sphere>(instance_.shape);
}

Vec3 Body::inwards(Vec3 point_m) const {
  return inverse(instance_.world_from_object) * point_m;
}

bool Body::contains(Vec3 point_m) const {
  const Vec3 p = inwards(point_m);
  if (const auto* sphere = std::get_if<Sphere>(&instance_.shape)) return norm(p) < sphere->radius_m;
  if (!mesh_ || outside_box(*mesh_, p, 0) || !closed()) return false;
  return std::abs(mesh::winding_number(*mesh_, p)) > 0.5;
}

bool Body::meets_ball(Vec3 centre_m, double radius_m) const {
  if (!(radius_m > 0)) return false;
  const Vec3 p = inwards(centre_m);
  if (const auto* sphere = std::get_if<Sphere>(&instance_.shape))
    return std::abs(norm(p) - sphere->radius_m) < radius_m;
  if (mesh_) return !outside_box(*mesh_, p, radius_m) && mesh::distance_m(*mesh_, p) < radius_m;
  const Plane& plane = std::get<Plane>(instance_.shape);
  const double beyond_x = std::max(0.0, std::abs(p.x) - plane.size_x_m / 2);
  const double beyond_y = std::max(0.0, std::abs(p.y) - plane.size_y_m / 2);
  return norm(Vec3{beyond_x, beyond_y, p.z}) < radius_m;
}

// Vertices of meshes, at most so many; a spiral over spheres; a grid over planes.
template <class Visit>
bool Body::any_point(std::size_t at_most, const Visit& visit) const {
  const auto& pose = instance_.world_from_object;
  if (mesh_) {
    const std::size_t step = std::max<std::size_t>(1, mesh_->positions_m.size() / at_most);
    for (std::size_t i = 0; i < mesh_->positions_m.size(); i += step)
      if (visit(pose * mesh_->positions_m[i])) return true;
    return false;
  }
  const int n = static_cast<int>(std::min<std::size_t>(at_most, 256));
  for (int i = 0; i < n; ++i) {
    Vec3 p;
    if (const auto* sphere = std::get_if<Sphere>(&instance_.shape)) {  // Fibonacci's spiral
      const double z = 1 - (2.0 * i + 1) / n, r = std::sqrt(1 - z * z), phi = i * pi * (3 - std::sqrt(5.0));
      p = Vec3{r * std::cos(phi), r * std::sin(phi), z} * sphere->radius_m;
    } else {
      const Plane& plane = std::get<Plane>(instance_.shape);
      const int side = static_cast<int>(std::sqrt(n));
      p = {((i % side) / (side - 1.0) - 0.5) * plane.size_x_m,
           ((i / side % side) / (side - 1.0) - 0.5) * plane.size_y_m, 0};
    }
    if (visit(pose * p)) return true;
  }
  return false;
}

bool Body::overlaps(const Body& other) const {
  return any_point(64, [&](Vec3 p) { return other.contains(p); });
}

bool Body::shows_in(const View& view) const {
  return any_point(100000, [&](Vec3 p) {
    const auto pixel = view.camera.project(inverse(view.world_from_camera) * p);
    return pixel && pixel->x > -0.5 && pixel->y > -0.5 && pixel->x < view.camera.width_px() - 0.5 &&
           pixel->y < view.camera.height_px() - 0.5;
  });
}

bool Body::met_by(Vec3 origin_m, Vec3 direction) const {
  const Vec3 o = inwards(origin_m), d = inverse(instance_.world_from_object).rotate(direction);
  if (const auto* sphere = std::get_if<Sphere>(&instance_.shape)) {
    const double along = -dot(o, d), squared = dot(o, o) - along * along, r2 = sphere->radius_m * sphere->radius_m;
    return squared < r2 && along + std::sqrt(r2 - squared) > 0;
  }
  if (const auto* plane = std::get_if<Plane>(&instance_.shape)) {
    const double t = d.z == 0 ? -1 : -o.z / d.z;
    const Vec3 p = o + d * t;
    return t > 0 && std::abs(p.x) <= plane->size_x_m / 2 && std::abs(p.y) <= plane->size_y_m / 2;
  }
  const auto& p = mesh_->positions_m;
  return std::ranges::any_of(mesh_->triangles,
                             [&](const auto& t) { return meets_triangle(o, d, p[t[0]], p[t[1]], p[t[2]]); });
}

}  // namespace gonio::scene
