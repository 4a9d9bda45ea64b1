// Where rays meet the instances of a scene. World frame, metres. Immutable after construction and safe from many
// threads.
//
// Triangles are found by Embree in single precision (in coordinates about the scene's centre) and then intersected once
// more in double precision; spheres and planes are intersected in double precision throughout. Rays that leave a
// surface do not meet it again at their origin: analytic shapes know that they were left (SurfacePoint::instance),
// points on triangles are moved along the geometric normal by about a millionth of the scene's size.
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "scene/scene.h"

namespace gonio::render {

inline constexpr double far_away = std::numeric_limits<double>::infinity();

struct SurfacePoint {
  std::uint32_t instance = 0;  // place in Scene::instances
  std::uint32_t surface = 0;   // place in Appearance::surfaces
  double distance_m = 0;       // along the ray that found it
  Vec3 position_m;
  Vec3 geometric_normal;  // unit, on the side that the ray came from
  Vec3 normal;  // for shading: interpolated on smooth meshes, same side; its angle to the ray is below 90 degrees
  bool outside = true;  // met from outside: geometric_normal is the outward one of a closed surface
  Vec3 tangent;         // along growing u, else along the object's x axis; not unit, not perpendicular to the normal
  std::uint32_t triangle = 0;  // of a mesh, and barycentric coordinates of its second and third vertex
  double b1 = 0, b2 = 0;
  Vec2 uv;  // sphere: (azimuth / 2 pi, polar angle from -z / pi); plane: [0, 1]^2; mesh: the file's, else (0, 0)
};

// The same point for rays that leave to the other side of the surface.
inline SurfacePoint beyond(SurfacePoint point) {
  point.geometric_normal = -point.geometric_normal;
  point.normal = -point.normal;
  point.outside = !point.outside;
  return point;
}

// Where a line meets one instance: enough to choose between such places.
struct LineMark {
  double distance_m = 0;  // single precision on meshes
  Vec3 geometric_normal;  // unit, either sign
  std::uint32_t number = 0;
};

class RayCaster {
 public:
  explicit RayCaster(std::span<const scene::Instance> instances);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  // First meeting of a ray that starts in free space, or on the surface `from`.
  std::optional<SurfacePoint> closest(Vec3 origin_m, Vec3 direction) const;
  std::optional<SurfacePoint> closest_from(const SurfacePoint& from, Vec3 direction) const;
  // Is there anything on the way from `from` along the unit `direction`, nearer than `distance_m`? Directions below the
  // geometric horizon are occluded by the surface itself.
  bool occluded(const SurfacePoint& from, Vec3 direction, double distance_m = far_away) const;
  // The same for a point in free space.
  bool blocked(Vec3 origin_m, Vec3 direction, double distance_m = far_away) const;
  // All meetings with one instance on the way, nearest first.
  std::vector<SurfacePoint> crossings(std::uint32_t instance, Vec3 origin_m, Vec3 direction, double distance_m) const;
  // The same places in one go and in no order, added to `marks`, and one of them worked out.
  void mark(std::uint32_t instance, Vec3 origin_m, Vec3 direction, double distance_m,
            std::vector<LineMark>& marks) const;
  SurfacePoint marked(std::uint32_t instance, Vec3 origin_m, Vec3 direction, double distance_m,
                      const LineMark& mark) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::render
