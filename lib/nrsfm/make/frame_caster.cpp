// See frame_caster.h.
#include "nrsfm/make/frame_caster.h"

#include <array>

#include "mesh/mesh.h"
#include "render/ray_caster.h"

namespace gonio::nrsfm {
namespace {

Vec3 vec(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

scene::Instance instance_of(const FrameMesh& frame) {
  auto mesh = std::make_shared<mesh::Mesh>();
  for (Eigen::Index v = 0; v < frame.vertices_m.cols(); ++v) mesh->positions_m.push_back(vec(frame.vertices_m.col(v)));
  mesh->triangles = frame.triangles;
  mesh->normals = mesh::averaged_normals(mesh->positions_m, mesh->triangles);
  scene::Instance instance;
  instance.id = "surface";
  instance.shape = std::shared_ptr<const mesh::Mesh>(std::move(mesh));
  return instance;
}

}  // namespace

struct FrameCaster::Impl {
  std::array<scene::Instance, 1> instances;
  render::RayCaster caster;
  explicit Impl(const FrameMesh& mesh) : instances{instance_of(mesh)}, caster(instances) {}
};

FrameCaster::FrameCaster(const FrameMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}
FrameCaster::~FrameCaster() = default;

std::optional<SurfaceHit> FrameCaster::closest(const Eigen::Vector3d& origin_m,
                                               const Eigen::Vector3d& direction) const {
  const auto met = impl_->caster.closest(vec(origin_m), vec(direction));
  if (!met) return std::nullopt;
  return SurfaceHit{met->distance_m, met->outside, {met->normal.x, met->normal.y, met->normal.z},
                    met->triangle,   met->b1,      met->b2};
}

}  // namespace gonio::nrsfm
