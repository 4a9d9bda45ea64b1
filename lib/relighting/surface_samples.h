// Points spread evenly over what belongs to one surface, and the light that they receive: what terms integrate over
// when light arrives elsewhere than where it is seen. World frame, metres.
#pragma once
#include <vector>

#include "relighting/light_cache.h"
#include "relighting/term.h"

namespace gonio::relighting {

struct SurfaceSamples {
  std::vector<Vec3> position_m;
  std::vector<float> irradiance;  // [point][light]: V cos / d^2, per unit of intensity
};

// About `count` points, each standing for the same area, on instances that bear `surface`, within the box.
SurfaceSamples surface_samples(const Setting& setting, std::size_t surface, Vec3 lower_m, Vec3 upper_m,
                               std::size_t count);

// V cos / d^2 (directional lights: V cos) at a point from a small light.
float received(const render::RayCaster& caster, const render::SurfacePoint& at, const LightSource& light);

}  // namespace gonio::relighting
