// Meshes of instances, vertex by vertex.
#pragma once
#include <algorithm>
#include <memory>
#include <variant>
#include <vector>

#include "scene/scene.h"

namespace gonio::scene {

// The mesh of `instance` becomes a copy whose positions are f(position_m, normal).
template <class F>
void each_vertex(Instance& instance, const F& f) {
  const auto& mesh = std::get<std::shared_ptr<const mesh::Mesh>>(instance.shape);
  auto copy = std::make_shared<mesh::Mesh>(*mesh);
  const std::vector<Vec3> normals =
      mesh->normals.empty() ? mesh::averaged_normals(mesh->positions_m, mesh->triangles) : mesh->normals;
  for (std::size_t i = 0; i < copy->positions_m.size(); ++i) copy->positions_m[i] = f(mesh->positions_m[i], normals[i]);
  instance.shape = std::shared_ptr<const mesh::Mesh>(std::move(copy));
}

// Of the box of all vertices that a triangle uses, in the mesh's frame.
inline Vec3 middle_of_box(const mesh::Mesh& mesh) {
  Vec3 lower = mesh.positions_m[mesh.triangles.front()[0]], upper = lower;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      const Vec3 p = mesh.positions_m[v];
      lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
      upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
    }
  return (lower + upper) * 0.5;
}

}  // namespace gonio::scene
