// Meshes of instances, vertex by vertex.
#pragma once
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

}  // namespace gonio::scene
