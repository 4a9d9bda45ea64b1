// Where the plane of the pattern lies in a picture: through a camera and a pose, or through a homography.
//
// A point (x, y) of the pattern is (x, y, 0) in its frame. Through a camera the mapping includes the lens; a homography
// is the mapping between two planes without one, (u, v, 1) ~ H (x, y, 1), determined by four points (Hartley &
// Zisserman 2004, section 4.1: direct linear transformation).
//
// A mapping that is not quite where it should be moves by the displacements d_k of the pattern's corners in the
// picture: q(x, y) + sum_k N_k(x, y) d_k with the bilinear N_k, which for displacements of pixels is the change of any
// pose, and of any homography.
#pragma once
#include <array>
#include <optional>

#include "camera/camera_model.h"
#include "geom/rigid.h"

namespace gonio::contrast {

using CornerShifts = std::array<Vec2, 4>;         // px, in the corners' order
using CornerCovariance = std::array<double, 64>;  // of u0 v0 u1 v1 u2 v2 u3 v3, px^2

// N_k at a place in shares of the pattern's width and height.
std::array<double, 4> corner_weights(Vec2 share);
double largest_sigma_px(const CornerCovariance& covariance);  // of one coordinate of one corner

class ViewMap {
 public:
  ViewMap(const camera::CameraModel& camera, const Rigid<frame::Camera, frame::Object>& camera_from_pattern);
  explicit ViewMap(const Mat3& pixel_from_plane);

  std::optional<Vec2> pixel(Vec2 plane_m) const;                // nothing behind the camera
  std::optional<Vec2> plane(Vec2 pixel) const;                  // nothing where the ray misses the plane
  ViewMap moved(const CornerShifts& by_px, Vec2 size_m) const;  // further in the picture; size of the pattern

 private:
  std::optional<camera::CameraModel> camera_;
  Rigid<frame::Camera, frame::Object> camera_from_pattern_;
  Rigid<frame::Object, frame::Camera> pattern_from_camera_;
  Mat3 pixel_from_plane_, plane_from_pixel_;
  std::optional<Vec2> unmoved(Vec2 pixel) const;
  Vec2 displacement(Vec2 plane_m) const;
  std::optional<CornerShifts> shifts_px_;
  Vec2 size_m_;
};

// Takes from[k] to to[k].
Mat3 homography(const std::array<Vec2, 4>& from, const std::array<Vec2, 4>& to);

}  // namespace gonio::contrast
