// Rays from the eye through a pixel, in the world frame: pinhole, distorted, fisheye and orthographic cameras as
// camera/camera_model.h has them, through a thin lens where the view has one (optics.defocus).
//
// Thin lens (Cook, Porter & Carpenter 1984; Kolb, Mitchell & Hanrahan 1995, section 2): everything on the plane
// z = focus_m of the camera frame is sharp. A ray that the pinhole at the origin sends through p = (x, y, focus_m)
// leaves a point of the lens instead, which is a disc of radius aperture_radius_m in the plane z = 0, drawn uniformly,
// and still goes through p. A point at depth z therefore spreads over a disc whose diameter, in pixels of a lens of
// focal length f_px, is
//   2 aperture_radius_m f_px |1/z - 1/focus_m|.
// A pixel is the mean over the lens of the radiance that arrives: the aperture does not change the exposure. Rays of
// orthographic cameras get a cone of the same half-width (object-side telecentric). Rays that leave at 90 degrees and
// more from the axis (fisheye) stay as they are.
#pragma once
#include "geom/vector.h"
#include "scene/scene.h"

namespace gonio::render {

struct WorldRay {
  Vec3 origin_m, direction;  // unit
};

class CameraRays {
 public:
  explicit CameraRays(const scene::View& view) : view_(view), rotation_(matrix_of(view.world_from_camera.rotation)) {}
  bool uses_lens() const { return view_.lens.aperture_radius_m > 0; }
  // `lens_u` in the unit square: where on the lens; without effect where uses_lens() is false.
  WorldRay at(Vec2 pixel, Vec2 lens_u) const;
  // Through the lens' centre.
  WorldRay principal(Vec2 pixel) const;

 private:
  const scene::View& view_;
  Mat3 rotation_;  // world_from_camera
};

inline WorldRay camera_ray(const scene::View& view, Vec2 pixel, Vec2 lens_u) {
  return CameraRays(view).at(pixel, lens_u);
}

}  // namespace gonio::render
