// A mirror ball before a camera: which direction of the surroundings its picture shows where.
//
// The ball has its true size and the camera its true distance. With D from the ball's centre o to the eye c, radius R,
// and all angles in the plane of v = (c - o) / D and the direction wanted: at the normal that leans from v by t, the
// eye sees the ball's point under the angle
//   a(t) = atan2(R sin t, D - R cos t)
// from the axis, light meets it under the incidence i = t + a, and what is seen there comes from the angle
//   gamma(t) = t + i = 2 t + a(t),        dgamma/dt = 2 + R (D cos t - R) / (D^2 - 2 D R cos t + R^2) > 0
// against v. A place at the finite distance Q from o under the angle gamma is met where the reflected ray goes through
// it (Alhazen's problem): the angle of q - p is 2 t + a. Newton's method in t, held between the last two signs.
// Grazing incidence ends at cos t = R / D; within asin(R / D) of -v, behind the ball, lie the directions that no point
// of it shows. A picture without perspective is the limit D -> infinity: a = 0, and only -v itself is hidden.
// World frame, metres, radians.
#pragma once
#include <limits>
#include <optional>

#include "geom/vector.h"

namespace gonio::probe {

struct Ball {
  Vec3 centre_m;
  double radius_m = 0;
};

class MirrorBall {
 public:
  MirrorBall(Ball ball, Vec3 eye_m);                               // Error(data) where the eye is not outside
  static MirrorBall parallel(const Ball& ball, Vec3 towards_eye);  // seen without perspective; unit vector

  struct Reflection {                 // of one ray from the eye
    Vec3 point_m, normal, direction;  // direction: unit, from the ball to what is seen in it
    double cosine = 0;                // of the angle of incidence
    double offset = 0;                // of the ray from the outline's middle, 0, to the outline, 1
  };
  // `origin_m`, unit `direction`: the ray through a pixel; nothing where it misses the ball.
  std::optional<Reflection> reflect(Vec3 origin_m, Vec3 direction) const;

  struct Shown {
    Vec3 point_m, normal;
    double cosine = 0, offset = 0;  // as above
    // How far the direction turns, rad, where the ray moves by one radius of the outline: away from its middle, and
    // round it. Their product over the square of the outline's radius in pixels is a pixel's solid angle.
    double along_rad = 0, across_rad = 0;
  };
  // Where the ball shows what lies in this direction from its centre (unit), infinitely far or at `distance_m`. Nothing
  // within the blind cone, and for a distance within the ball.
  std::optional<Shown> shown(Vec3 direction, double distance_m = std::numeric_limits<double>::infinity()) const;
  // The same two slopes at the offset of a reflection.
  Vec2 spread_rad(double offset) const;

  double blind_half_angle_rad() const;                   // about -towards_eye()
  Vec3 towards_eye() const { return axis_; }             // unit
  double eye_distance_m() const { return distance_m_; }  // infinite without perspective
  const Ball& ball() const { return ball_; }

 private:
  MirrorBall() = default;
  double eye_angle(double lean) const;
  double eye_angle_slope(double lean) const;
  double offset_of(double lean) const;
  double offset_slope(double lean) const;
  double lean_of(double offset) const;
  double largest_lean() const;

  Ball ball_;
  Vec3 axis_{0, 0, 1};
  double distance_m_ = std::numeric_limits<double>::infinity();
  double size_ = 0;  // R / D
};

}  // namespace gonio::probe
