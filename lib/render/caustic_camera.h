// Where a camera sees a point, for paths that begin at the lights. World frame, metres; the inverse of camera_ray.h.
//
// A pixel's value is the mean over its square of the radiance that arrives. Where a patch of area dA perpendicular to
// the line of sight covers J dA pixels, a photon of flux Phi that the patch turns towards the camera with the BRDF f
// adds  Phi f |cos at the patch| J  to the pixel: J for a pinhole is f_px^2 / (d^2 cos^3) and is found for every
// camera and distortion by central differences of the projection.
#pragma once
#include <optional>

#include "scene/scene.h"

namespace gonio::render {

struct Sight {
  Vec3 origin_m;  // on the lens
  Vec2 pixel;
  double pixels_per_m2 = 0;  // perpendicular to the line of sight
};

class CausticCamera {
 public:
  explicit CausticCamera(const scene::View& view);
  bool uses_lens() const { return view_.lens.aperture_radius_m > 0; }
  // Nothing where the point is outside of the picture.
  std::optional<Sight> sight(Vec3 point_m, Vec2 lens_u) const;

 private:
  std::optional<Vec2> pixel(Vec3 local_m, Vec2 offset_m) const;  // camera frame; offset: on the lens

  const scene::View& view_;
  Mat3 world_from_camera_, camera_from_world_;
};

}  // namespace gonio::render
