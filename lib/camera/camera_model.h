// The camera as a mapping between rays and pixels. Camera axes: x right, y down, z forward; pixel centres at integers.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "geom/vector.h"
#include "manifest/sections.h"

namespace gonio::camera {

struct Ray {  // camera frame
  Vec3 origin_m, direction;  // direction is a unit vector
};

// pinhole, radial-tangential (k1 k2 p1 p2 k3, Brown 1966, in OpenCV's order and sign), thin-prism (s1 s2 s3 s4 on top), and
// orthographic (px_per_m; rays parallel to +z through the plane z = 0; the same distortion terms do not apply).
class CameraModel {
 public:
  // `place` is where the section stands, for messages. Error(data) for unknown models, distortion names, sizes or f <= 0.
  CameraModel(const manifest::Camera& camera, const std::string& place);

  // Pixel of a point in the camera frame, metres; nothing for points behind a perspective camera or beyond the radius up to
  // which the distortion is one-to-one.
  std::optional<Vec2> project(Vec3 point_m) const;
  // Ray through a pixel position (Newton iteration on the distortion to 1e-12; continues undistorted where it has no inverse).
  Ray ray(Vec2 pixel) const;

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  Vec2 principal_point_px() const { return {cx_px_, cy_px_}; }
  bool orthographic() const { return orthographic_; }

 private:
  int width_px_ = 0, height_px_ = 0;
  double fx_px_ = 0, fy_px_ = 0, cx_px_ = 0, cy_px_ = 0;
  std::array<double, 9> distortion_{};  // k1 k2 p1 p2 k3 s1 s2 s3 s4
  bool distorted_ = false, orthographic_ = false;
  double radius_limit_ = 0;  // largest normalised radius at which the radial part still grows
};

}  // namespace gonio::camera
