// A point on a surface, prepared for shading. Directions `wo`, `wi` are local to the shading frame: +z the normal on
// the eye's side, +x along the surface's tangent.
#pragma once
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::render {

// The shading frame of a point: its x axis is the tangent made perpendicular to the normal, turned with it.
Basis shading_frame(const SurfacePoint& point);

// Where on its object a point lies.
scene::Place place_of(const SurfacePoint& point, const scene::Instance& instance);

// Parameter values at `point`; `base` holds those of the surface beneath, if there is one, and must outlive them.
surface::Values values_at(const scene::Scene& scene, const SurfacePoint& point, surface::Layer& base);

struct Vertex {
  SurfacePoint point;
  const surface::Model* model;
  surface::Layer base;
  surface::Values values;
  Basis frame;
  Vec3 wo;
  Vertex(const scene::Scene& scene, const SurfacePoint& at, Vec3 to_eye)
      : point(at),
        model(scene.appearance.surfaces[at.surface].model),
        values(values_at(scene, at, base)),
        frame(shading_frame(at)),
        wo(frame.to_local(to_eye)) {}
  Vertex(const Vertex&) = delete;  // values.base points into it
  Vertex& operator=(const Vertex&) = delete;
};

}  // namespace gonio::render
