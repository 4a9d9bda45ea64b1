// geometry.shrinkage: about the middle of the box, along the object's own axes.
#include <cmath>
#include <memory>

#include "scene/edit.h"
#include "scene/vertices.h"

namespace gonio::mechanism {
const Mechanism& geometry_shrinkage();
}

namespace gonio::scene::edits {
namespace {

void shrink(Instance& instance, std::span<const double> a) {
  if (a[0] == 0 && a[1] == 0 && a[2] == 0) return;
  const Vec3 factor{1 - a[0], 1 - a[1], 1 - a[2]};
  if (auto* sphere = std::get_if<Sphere>(&instance.shape)) {
    sphere->radius_m *= std::cbrt(factor.x * factor.y * factor.z);  // a ball stays one: of the same volume
  } else if (auto* plane = std::get_if<Plane>(&instance.shape)) {
    plane->size_x_m *= factor.x, plane->size_y_m *= factor.y;
  } else {
    const auto& mesh = *std::get<std::shared_ptr<const mesh::Mesh>>(instance.shape);
    const Vec3 middle = middle_of_box(mesh);
    auto copy = std::make_shared<mesh::Mesh>(mesh);
    for (Vec3& p : copy->positions_m) p = p - Vec3{a[0], a[1], a[2]} * (p - middle);
    for (Vec3& n : copy->normals) n = normalized(Vec3{n.x / factor.x, n.y / factor.y, n.z / factor.z});
    instance.shape = std::shared_ptr<const mesh::Mesh>(std::move(copy));
  }
}

}  // namespace

const Edit& geometry_shrinkage() {
  static const Edit edit{.mechanism = mechanism::geometry_shrinkage, .instance = shrink};
  return edit;
}

}  // namespace gonio::scene::edits
