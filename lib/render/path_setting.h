// What all paths of one view share, whatever they carry. World frame, metres.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "render/camera_ray.h"
#include "render/caustic_sources.h"
#include "render/integrator.h"
#include "render/media.h"

namespace gonio::render {

struct PathSetting {
  PathSetting(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Transport& transport);

  Vec3 camera_x() const { return x_axis; }
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
  CameraRays rays;
  Vec3 x_axis;                                  // the picture's x axis in the world
  std::vector<const light::Emitter*> emitters;  // the named ones first, then ambient
  std::size_t named = 0;
  std::vector<bool> transmits;  // of the surfaces
  std::vector<bool> spreads;    // of the surfaces: not smooth everywhere, so that sampled light may find its way
  Media media;
  Inside camera_inside;                    // what the camera's centre is in
  std::optional<CausticSources> caustics;  // what is left to paths from the lights, where there is any
  bool left_to_lights(std::size_t emitter) const { return caustics && caustics->traces(emitter); }
};

}  // namespace gonio::render
