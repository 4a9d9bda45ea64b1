// What all paths of one view share, whatever they carry. World frame, metres.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "render/integrator.h"
#include "render/media.h"

namespace gonio::render {

struct PathSetting {
  PathSetting(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Transport& transport);

  std::pair<Vec3, Vec3> world_ray(Vec2 pixel) const;  // origin and unit direction
  Vec3 camera_x() const { return {rotation(0, 0), rotation(1, 0), rotation(2, 0)}; }
  Rgb scale(Vec2 pixel) const;  // of radiance to the picture's values
  // "light.NAME" of all emitters, where they have planes of their own.
  std::vector<std::string> light_planes() const;
  // Share of light that arrives from `distance_m` away; see Media::clear.
  Rgb clear(const SurfacePoint* from, Vec3 origin_m, const Inside& inside, Vec3 direction, double distance_m) const;
  PixelGeometry geometry(int x, int y, const Noticed& noticed) const;

  const scene::Scene& scene;
  const scene::View& view;
  const RayCaster& caster;
  Transport transport;
  Mat3 rotation;                                // world_from_camera
  std::vector<const light::Emitter*> emitters;  // the named ones first, then ambient
  std::size_t named = 0;
  std::vector<bool> transmits;  // of the surfaces
  Media media;
  Inside camera_inside;  // what the camera's centre is in
};

}  // namespace gonio::render
