// Spheres and planes, intersected exactly. World frame, metres; bounds are relative to a given centre.
#pragma once
#include <optional>

#include "geom/vector.h"
#include "scene/scene.h"

namespace gonio::render {

struct AnalyticShape {
  bool sphere = false;
  Vec3 centre_m;
  Vec3 x, y, z;                       // the object's axes
  double radius_m = 0;                // sphere
  double half_x_m = 0, half_y_m = 0;  // plane
  Vec3 low, high;                     // bounds, relative to the given centre
};
struct AnalyticRay {
  Vec3 origin_m, direction;
  Vec3 left_normal;  // geometric normal of the point that the ray leaves, on the ray's side
};
struct AnalyticHit {
  double distance_m = 0;
  Vec3 position_m, normal;  // unit; outwards, or the plane's +z
  Vec2 uv;
  Vec3 tangent;  // along growing u
};

// Empty where the instance is a mesh.
AnalyticShape analytic_shape(const scene::Instance& instance, Vec3 centre_m);

// Distance along the ray. `leaves`: its origin lies on this very shape, which it does not meet there again. A sphere
// that is left to its inside is met at its far side.
std::optional<double> distance_to(const AnalyticShape& shape, const AnalyticRay& ray, bool leaves);
// What is there, at a distance that distance_to() has found.
AnalyticHit hit_at(const AnalyticShape& shape, const AnalyticRay& ray, double distance_m);

}  // namespace gonio::render
