// geometry.offset: along the normals.
#include "scene/edit.h"
#include "scene/vertices.h"

namespace gonio::mechanism {
const Mechanism& geometry_offset();
}

namespace gonio::scene::edits {
namespace {

void offset(Instance& instance, std::span<const double> a) {
  if (auto* sphere = std::get_if<Sphere>(&instance.shape))
    sphere->radius_m += a[0];
  else if (std::holds_alternative<Plane>(instance.shape))
    instance.world_from_object.translation_m += instance.world_from_object.rotate({0, 0, a[0]});
  else
    each_vertex(instance, [&](Vec3 p, Vec3 normal) { return p + normal * a[0]; });
}

}  // namespace

const Edit& geometry_offset() {
  static const Edit edit{.mechanism = mechanism::geometry_offset, .instance = offset};
  return edit;
}

}  // namespace gonio::scene::edits
