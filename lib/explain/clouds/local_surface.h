// What a cloud's points about one of its pixels say of the surface there. Private to clouds/.
#pragma once
#include <optional>

#include "explain/clouds/cloud_reading.h"
#include "mesh/clean/local_quadratic.h"

namespace gonio::explain {

// A height of second degree over a plane, by least squares of the points within `local_reach` pixels. Rig frame.
class LocalSurface {
 public:
  static constexpr long local_reach = 3;
  // Nothing where a third of the neighbours have no point, or where they lie far off one smooth surface: at an edge.
  static std::optional<LocalSurface> about(std::span<const scan::ScanPoint> points, const PointsByPixel& by_pixel,
                                           Vec2 pixel);
  double off(Vec3 point) const;                  // signed distance, towards the rig's origin positive
  Vec3 normal(Vec3 point) const;                 // unit, towards the rig's origin
  Vec3 along(Vec3 point, Vec3 direction) const;  // where a line through a point near it meets it

 private:
  Vec3 local(Vec3 point) const;  // over the plane, in units of `scale_`
  Vec2 slope(Vec3 point) const;
  Vec3 middle_;
  Basis basis_{Vec3{0, 0, 1}};
  double scale_ = 1;
  mesh::LocalQuadratic::Fit fit_;
};

}  // namespace gonio::explain
