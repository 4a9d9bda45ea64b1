// Rays against the surface of one frame: the ray caster of the renderer in the types of this room.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>

#include "nrsfm/make/occlusion.h"

namespace gonio::nrsfm {

struct SurfaceHit {
  double distance_m = 0;
  bool outside = true;     // met from the side that sees the triangle's corners counter-clockwise
  Eigen::Vector3d normal;  // unit, towards the ray, averaged at the vertices
  std::uint32_t triangle = 0;
  double b1 = 0, b2 = 0;  // weights of its second and third corner
};

class FrameCaster {
 public:
  explicit FrameCaster(const FrameMesh& mesh);
  ~FrameCaster();
  std::optional<SurfaceHit> closest(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::nrsfm
