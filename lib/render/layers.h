// Layers of a picture that are no estimates: what the rays through the pixels' centres meet. World frame, metres.
//
//   id                  place of the object in the manifest + 1; 0: nothing
//   position.X/Y/Z      normal.X/Y/Z (for shading, on the camera's side)
//   distance.LIGHT      to the nearest point of each light that is on; 0 where it is infinitely far
//   depth.Z             along the camera's axis
//   back_normal.X/Y/Z   where some surface lets light through: outward normal of the last meeting of the straight ray
//                       with the object that it meets first, if that object lets light through; else zero. The ray is
//                       not refracted: this is the shape's back side, not what is seen through it.
#pragma once
#include "io/image.h"
#include "render/integrator.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::render {

io::Image geometry_layers(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                          const Integrator& integrator);

}  // namespace gonio::render
