// geometry.scale: about the object's own origin.
#include "scene/edit.h"
#include "scene/vertices.h"

namespace gonio::mechanism {
const Mechanism& geometry_scale();
}

namespace gonio::scene::edits {
namespace {

void grow(Instance& instance, std::span<const double> a) {
  if (auto* sphere = std::get_if<Sphere>(&instance.shape)) {
    sphere->radius_m *= 1 + a[0];
  } else if (auto* plane = std::get_if<Plane>(&instance.shape)) {
    plane->size_x_m *= 1 + a[0];
    plane->size_y_m *= 1 + a[0];
  } else {
    each_vertex(instance, [&](Vec3 p, Vec3) { return p * (1 + a[0]); });
  }
}

}  // namespace

const Edit& geometry_scale() {
  static const Edit edit{.mechanism = mechanism::geometry_scale, .instance = grow};
  return edit;
}

}  // namespace gonio::scene::edits
