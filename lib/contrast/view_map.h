// Where the plane of the pattern lies in a picture: through a camera and a pose, or through a homography.
//
// A point (x, y) of the pattern is (x, y, 0) in its frame. Through a camera the mapping includes the lens; a homography
// is the mapping between two planes without one, (u, v, 1) ~ H (x, y, 1), determined by four points (Hartley &
// Zisserman 2004, section 4.1: direct linear transformation).
#pragma once
#include <array>
#include <optional>

#include "camera/camera_model.h"
#include "geom/rigid.h"

namespace gonio::contrast {

class ViewMap {
 public:
  ViewMap(const camera::CameraModel& camera, const Rigid<frame::Camera, frame::Object>& camera_from_pattern);
  explicit ViewMap(const Mat3& pixel_from_plane);

  std::optional<Vec2> pixel(Vec2 plane_m) const;  // nothing behind the camera
  std::optional<Vec2> plane(Vec2 pixel) const;    // nothing where the ray misses the plane
  ViewMap shifted(Vec2 by_px) const;              // everything lies so much further in the picture

 private:
  std::optional<camera::CameraModel> camera_;
  Rigid<frame::Camera, frame::Object> camera_from_pattern_;
  Rigid<frame::Object, frame::Camera> pattern_from_camera_;
  Mat3 pixel_from_plane_, plane_from_pixel_;
  Vec2 shift_px_;
};

// Takes from[k] to to[k].
Mat3 homography(const std::array<Vec2, 4>& from, const std::array<Vec2, 4>& to);

}  // namespace gonio::contrast
