#include "render/vertex.h"

#include <cmath>

namespace gonio::render {

Basis shading_frame(const SurfacePoint& point) {
  const Vec3 along = point.tangent - point.normal * dot(point.tangent, point.normal);
  const double square = dot(along, along);
  return square > 1e-12 * dot(point.tangent, point.tangent) ? Basis(point.normal, along * (1 / std::sqrt(square)))
                                                            : Basis(point.normal);
}

scene::Place place_of(const SurfacePoint& point, const scene::Instance& instance) {
  const Mat3 to_object = transposed(matrix_of(instance.world_from_object.rotation));
  const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape);
  return {point.uv,
          to_object * (point.position_m - instance.world_from_object.translation_m),
          to_object * (point.outside ? point.normal : -point.normal),
          mesh ? mesh->get() : nullptr,
          point.triangle,
          point.b1,
          point.b2};
}

surface::Values values_at(const scene::Scene& scene, const SurfacePoint& point, surface::Layer& base) {
  const scene::Surface& surface = scene.appearance.surfaces[point.surface];
  const auto here = [&](const scene::Surface& s) {
    return s.varies() ? s.values_at(place_of(point, scene.instances[point.instance])) : s.values;
  };
  surface::Values values = here(surface);
  if (!surface.base) return values;
  const scene::Surface& beneath = scene.appearance.surfaces[*surface.base];
  base = {beneath.model, here(beneath)};
  values.base = &base;
  return values;
}

Vertex::Vertex(const scene::Scene& scene, const SurfacePoint& at, Vec3 to_eye,
               const std::optional<InterfaceHere>& interface_here)
    : point(at),
      model(scene.appearance.surfaces[at.surface].model),
      values(values_of(scene, interface_here)),
      frame(shading_frame(at)),
      wo(frame.to_local(to_eye)) {}

// Most surfaces are the same everywhere, bound no medium and are seen from outside: theirs are used in place.
const surface::Values& Vertex::values_of(const scene::Scene& scene,
                                         const std::optional<InterfaceHere>& interface_here) {
  const scene::Surface& surface = scene.appearance.surfaces[point.surface];
  if (!surface.varies() && !surface.base && !interface_here && point.outside) return surface.values;
  if (surface.base) {
    own_ = values_at(scene, point, base_.emplace());
  } else if (surface.varies()) {
    own_ = surface.values_at(place_of(point, scene.instances[point.instance]));
  } else {
    own_ = surface.values;
  }
  if (interface_here) {
    own_->eta = interface_here->eta;
    own_->hero = interface_here->hero;
  }
  own_->inside = !point.outside;
  if (surface.base) base_->values.inside = own_->inside;
  return *own_;
}

}  // namespace gonio::render
