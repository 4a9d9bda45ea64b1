// geometry.bend: about the middle of the box, along the object's own axes.
#include <memory>

#include "scene/edit.h"
#include "scene/mechanisms/bend.h"
#include "scene/vertices.h"

namespace gonio::mechanism {
const Mechanism& geometry_bend();
}

namespace gonio::scene::edits {
namespace {

// Balls stay balls, and planes are the ground's (ground.not-flat).
void bend(Instance& instance, std::span<const double> a) {
  const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape);
  if (mesh == nullptr) return;
  const Vec3 middle = middle_of_box(**mesh);
  auto copy = std::make_shared<mesh::Mesh>(**mesh);
  for (std::size_t v = 0; v < copy->positions_m.size(); ++v) {
    Vec3& p = copy->positions_m[v];
    if (!copy->normals.empty()) {  // of a shear along z: those of the slopes are taken off
      const Vec3 n = copy->normals[v], d = p - middle;
      copy->normals[v] =
          normalized(Vec3{n.x - n.z * (a[0] * d.x + a[2] * d.y), n.y - n.z * (a[2] * d.x + a[1] * d.y), n.z});
    }
    p = equation::bent(p, middle, a);
  }
  instance.shape = std::shared_ptr<const mesh::Mesh>(std::move(copy));
}

}  // namespace

const Edit& geometry_bend() {
  static const Edit edit{.mechanism = mechanism::geometry_bend, .instance = bend};
  return edit;
}

}  // namespace gonio::scene::edits
