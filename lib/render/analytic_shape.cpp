#include "render/analytic_shape.h"

#include <algorithm>
#include <cmath>

namespace gonio::render {
namespace {

// With a = c - o, b = a.d and q = a - b d, the distances are b -+ sqrt(r^2 - q.q): no cancellation for far or small
// spheres (Haines et al. 2019, Ray Tracing Gems, chapter 7). For an origin on the sphere they are 0 and 2 b.
std::optional<double> to_sphere(const AnalyticShape& sphere, const AnalyticRay& ray, bool leaves) {
  const Vec3 arm = sphere.centre_m - ray.origin_m;
  const double along = dot(arm, ray.direction);
  double distance;
  if (leaves) {
    if (dot(ray.left_normal, arm) <= 0) return {};  // to the outside of a convex body
    distance = 2 * along;
  } else {
    const Vec3 across = arm - ray.direction * along;
    const double depth = sphere.radius_m * sphere.radius_m - dot(across, across);
    if (depth < 0) return {};
    const double root = std::sqrt(depth);
    distance = along - root > 0 ? along - root : along + root;
  }
  if (!(distance > 0)) return {};
  return distance;
}

std::optional<double> to_plane(const AnalyticShape& plane, const AnalyticRay& ray, bool leaves) {
  const double slope = dot(plane.z, ray.direction);
  if (leaves || slope == 0) return {};
  const double distance = dot(plane.z, plane.centre_m - ray.origin_m) / slope;
  if (!(distance > 0) || !std::isfinite(distance)) return {};
  const Vec3 arm = ray.origin_m + ray.direction * distance - plane.centre_m;
  if (std::abs(dot(arm, plane.x)) > plane.half_x_m || std::abs(dot(arm, plane.y)) > plane.half_y_m) return {};
  return distance;
}

AnalyticHit on_sphere(const AnalyticShape& sphere, const AnalyticRay& ray, double distance_m) {
  const Vec3 normal = normalized(ray.origin_m + ray.direction * distance_m - sphere.centre_m);
  const Vec3 local{dot(normal, sphere.x), dot(normal, sphere.y), dot(normal, sphere.z)};
  const Vec2 uv{0.5 + std::atan2(local.y, local.x) / (2 * pi), 1 - std::acos(std::clamp(local.z, -1.0, 1.0)) / pi};
  return {distance_m, sphere.centre_m + normal * sphere.radius_m, normal, uv, cross(sphere.z, normal)};
}

AnalyticHit on_plane(const AnalyticShape& plane, const AnalyticRay& ray, double distance_m) {
  const Vec3 arm = ray.origin_m + ray.direction * distance_m - plane.centre_m;
  const double x = dot(arm, plane.x), y = dot(arm, plane.y);
  return {distance_m,
          plane.centre_m + plane.x * x + plane.y * y,
          plane.z,
          {0.5 + 0.5 * x / plane.half_x_m, 0.5 + 0.5 * y / plane.half_y_m},
          plane.x};
}

}  // namespace

AnalyticShape analytic_shape(const scene::Instance& instance, Vec3 centre_m) {
  AnalyticShape shape;
  const auto& pose = instance.world_from_object;
  shape.centre_m = pose.translation_m;
  shape.x = pose.rotate({1, 0, 0});
  shape.y = pose.rotate({0, 1, 0});
  shape.z = pose.rotate({0, 0, 1});
  Vec3 reach;
  if (const auto* sphere = std::get_if<scene::Sphere>(&instance.shape)) {
    shape.sphere = true;
    shape.radius_m = sphere->radius_m;
    reach = {sphere->radius_m, sphere->radius_m, sphere->radius_m};
  } else if (const auto* plane = std::get_if<scene::Plane>(&instance.shape)) {
    shape.half_x_m = plane->size_x_m / 2;
    shape.half_y_m = plane->size_y_m / 2;
    const Vec3 a = shape.x * shape.half_x_m, b = shape.y * shape.half_y_m;
    reach = {std::abs(a.x) + std::abs(b.x), std::abs(a.y) + std::abs(b.y), std::abs(a.z) + std::abs(b.z)};
  }
  shape.low = shape.centre_m - centre_m - reach;
  shape.high = shape.centre_m - centre_m + reach;
  return shape;
}

std::optional<double> distance_to(const AnalyticShape& shape, const AnalyticRay& ray, bool leaves) {
  return shape.sphere ? to_sphere(shape, ray, leaves) : to_plane(shape, ray, leaves);
}

AnalyticHit hit_at(const AnalyticShape& shape, const AnalyticRay& ray, double distance_m) {
  return shape.sphere ? on_sphere(shape, ray, distance_m) : on_plane(shape, ray, distance_m);
}

}  // namespace gonio::render
