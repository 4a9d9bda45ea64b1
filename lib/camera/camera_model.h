// The camera as a mapping between rays and pixels. Camera axes: x right, y down, z forward; pixel centres at integers.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "camera/intrinsics.h"
#include "geom/vector.h"
#include "manifest/sections/forward.h"

namespace gonio::equation {
struct FlatPort;  // camera/mechanisms/camera_flat_port.h
}

namespace gonio::camera {

struct Ray {                 // camera frame
  Vec3 origin_m, direction;  // direction is a unit vector
};

// pinhole to fisheye: central projection with the terms of lens_terms.h. orthographic: rays
// parallel to +z through the plane z = 0, px_per_m (one number, or two for x and y), principal point by default in the
// middle of the image.
class CameraModel {
 public:
  // `place` is where the section stands, for messages. Error(data) for unknown models, distortion names, sizes or f <=
  // 0.
  CameraModel(const manifest::Camera& camera, const std::string& place);
  CameraModel(const Intrinsics& lens, int width_px, int height_px);
  // Orthographic, its principal point in the middle of the image.
  static CameraModel parallel(double px_per_m, int width_px, int height_px);

  // Pixel of a point in the camera frame, metres; nothing for points behind a perspective camera or beyond the radius
  // up to which the distortion is one-to-one. A fisheye sees beyond 90 degrees from its axis.
  std::optional<Vec2> project(Vec3 point_m) const;
  // Ray through a pixel position (Newton iteration on the distortion to 1e-12; continues undistorted where it has no
  // inverse).
  Ray ray(Vec2 pixel) const;

  const Intrinsics& intrinsics() const { return lens_; }  // orthographic: fx_px, fy_px are pixels per metre
  // The same camera with other numbers, its picture's size, pupil and readout kept.
  CameraModel with(const Intrinsics& lens) const;
  // The same view with `factor` x `factor` pixels in the place of each: pixel n holds those from factor n on.
  CameraModel finer(int factor) const;
  // lens.non-central: rays at the angle theta pass through (0, 0, pupil_m sin^2 theta).
  CameraModel with_pupil(double pupil_m) const;
  // camera.flat-port: beyond a plane rays go on refracted. Not of orthographic cameras.
  CameraModel with_port(const equation::FlatPort& port) const;
  // camera.rolling-shutter: all that is seen shifts by (x, y, 0) in the camera frame during one readout.
  CameraModel with_motion(Vec2 motion_m) const;

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  Vec2 principal_point_px() const { return {lens_.cx_px, lens_.cy_px}; }
  bool orthographic() const { return orthographic_; }
  bool operator==(const CameraModel&) const = default;

 private:
  CameraModel() = default;
  void find_limits();
  Vec2 undistort(Vec2 distorted) const;
  std::optional<Vec2> project_at_rest(Vec3 point_m) const;
  Ray central_ray(Vec2 pixel) const;
  Vec3 shift_of_row(double row) const;

  int width_px_ = 0, height_px_ = 0;
  Intrinsics lens_;  // orthographic: fx_px, fy_px are pixels per metre
  bool distorted_ = false, orthographic_ = false;
  double pupil_m_ = 0;
  std::array<double, 4> port_{1, 0, 0, 0};  // index, distance, tilts
  Vec2 motion_m_;
  int factor_ = 1;           // pixels a side for one of the sensor's
  double radius_limit_ = 0;  // largest radius on the plane at which the radial part still grows
};

}  // namespace gonio::camera
