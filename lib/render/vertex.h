// A point on a surface, prepared for shading. Directions `wo`, `wi` are local to the shading frame: +z the normal on
// the eye's side, +x along the surface's tangent.
#pragma once
#include <optional>

#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::render {

// The shading frame of a point: its x axis is the tangent made perpendicular to the normal, turned with it.
Basis shading_frame(const SurfacePoint& point);

// Where on its object a point lies.
scene::Place place_of(const SurfacePoint& point, const scene::Instance& instance);

// Parameter values at `point`; `base` holds those of the surface beneath, if there is one, and must outlive them.
surface::Values values_at(const scene::Scene& scene, const SurfacePoint& point, surface::Layer& base);

// What the media on both sides add to a surface's values.
struct InterfaceHere {
  Rgb eta{1, 1, 1};  // index beyond over index on the eye's side
  int hero = 0;      // band by which directions of refraction are drawn
};

class Vertex {
 public:
  Vertex(const scene::Scene& scene, const SurfacePoint& at, Vec3 to_eye,
         const std::optional<InterfaceHere>& interface_here = {});
  Vertex(const Vertex&) = delete;  // `values` may refer into it
  Vertex& operator=(const Vertex&) = delete;

 private:
  const surface::Values& values_of(const scene::Scene& scene, const std::optional<InterfaceHere>& interface_here);
  std::optional<surface::Layer> base_;
  std::optional<surface::Values> own_;  // where they are not those of the whole surface

 public:
  SurfacePoint point;
  const surface::Model* model;
  const surface::Values& values;
  Basis frame;
  Vec3 wo;
};

}  // namespace gonio::render
