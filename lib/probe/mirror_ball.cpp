// The two ways between rays and directions; everything is scaled by the ball's radius over the eye's distance.
#include "probe/mirror_ball.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace gonio::probe {
namespace {

constexpr int most_steps = 60;

// The place of the root of `f` (value, slope; rising) between `low` and `high`.
template <class Function>
double rising_root(double low, double high, const Function& f) {
  double x = (low + high) / 2;
  for (int step = 0; step < most_steps; ++step) {
    const auto [value, slope] = f(x);
    (value > 0 ? high : low) = x;
    double next = x - value / slope;
    if (!(next > low && next < high)) next = (low + high) / 2;
    if (std::abs(next - x) < 1e-15) return next;
    x = next;
  }
  return x;
}

// Unit, at right angles to the axis, towards `direction`; any such one for what lies on the axis.
Vec3 sideways(Vec3 axis, Vec3 direction) {
  const Vec3 across = direction - axis * dot(axis, direction);
  return norm(across) > 1e-14 ? normalized(across) : Basis(axis).t;
}

}  // namespace

MirrorBall::MirrorBall(Ball ball, Vec3 eye_m) : ball_(ball) {
  distance_m_ = norm(eye_m - ball.centre_m);
  if (!(ball.radius_m > 0) || !(distance_m_ > ball.radius_m))
    throw Error(Exit::data, "ball",
                format("has a radius of %g m, and the camera stands %g m from its centre", ball.radius_m, distance_m_),
                "the camera must be outside of the ball");
  axis_ = (eye_m - ball.centre_m) / distance_m_;
  size_ = ball.radius_m / distance_m_;
}

MirrorBall MirrorBall::parallel(const Ball& ball, Vec3 towards_eye) {
  MirrorBall seen;
  seen.ball_ = ball;
  seen.axis_ = towards_eye;
  return seen;
}

double MirrorBall::eye_angle(double lean) const {
  return std::atan2(size_ * std::sin(lean), 1 - size_ * std::cos(lean));
}
double MirrorBall::eye_angle_slope(double lean) const {
  const double c = std::cos(lean);
  return size_ * (c - size_) / (1 - 2 * size_ * c + size_ * size_);
}
double MirrorBall::largest_lean() const {
  return std::acos(size_);
}
// sin(a) / sin(a of the outline), sin(a of the outline) = R / D.
double MirrorBall::offset_of(double lean) const {
  return std::sin(lean) / std::sqrt(1 - 2 * size_ * std::cos(lean) + size_ * size_);
}
double MirrorBall::offset_slope(double lean) const {
  const double c = std::cos(lean), s = std::sin(lean), d2 = 1 - 2 * size_ * c + size_ * size_;
  return (c - size_ * s * s / d2) / std::sqrt(d2);
}
// The incidence i has sin(i) = offset (the sine rule), and a = asin(size offset), t = i - a.
double MirrorBall::lean_of(double offset) const {
  const double s = std::clamp(offset, 0.0, 1.0);
  return std::asin(s) - std::asin(size_ * s);
}

double MirrorBall::blind_half_angle_rad() const {
  return std::asin(size_);
}

Vec2 MirrorBall::spread_rad(double offset) const {
  constexpr double least = 1e-9;  // on the axis both are the same limit
  const double s = std::clamp(offset, least, 1 - least), t = lean_of(s);
  return {(2 + eye_angle_slope(t)) / std::max(offset_slope(t), 1e-12), std::sin(2 * t + eye_angle(t)) / s};
}

std::optional<MirrorBall::Reflection> MirrorBall::reflect(Vec3 origin_m, Vec3 direction) const {
  const Vec3 to_centre = ball_.centre_m - origin_m;
  const double near = dot(to_centre, direction);
  const double miss = norm(to_centre - direction * near), inside = ball_.radius_m * ball_.radius_m - miss * miss;
  if (!(near > 0) || !(inside > 0)) return {};
  Reflection r;
  r.point_m = origin_m + direction * (near - std::sqrt(inside));
  r.normal = (r.point_m - ball_.centre_m) / ball_.radius_m;
  r.cosine = std::clamp(-dot(r.normal, direction), 0.0, 1.0);
  r.direction = normalized(direction + r.normal * (2 * r.cosine));
  r.offset = miss / ball_.radius_m;
  return r;
}

std::optional<MirrorBall::Shown> MirrorBall::shown(Vec3 direction, double distance_m) const {
  const double gamma = std::atan2(norm(cross(axis_, direction)), dot(axis_, direction)), most = largest_lean();
  const double away = ball_.radius_m / distance_m;  // zero: infinitely far
  if (!(away < 1)) return {};
  // By how much the reflected ray of the lean t passes the place, as an angle at the ball's point. The way from there
  // to the place turns from gamma by less than a right angle, which keeps the angle continuous.
  const auto missed = [&](double t) {
    const double x = 1 - away * std::cos(gamma - t), y = away * std::sin(gamma - t), squared = x * x + y * y;
    const double turn_slope = (y * y - away * std::cos(gamma - t) * x) / squared;
    return std::pair(2 * t + eye_angle(t) - gamma - std::atan2(y, x), 2 + eye_angle_slope(t) - turn_slope);
  };
  if (!(missed(most).first > 0)) return {};
  const double t = rising_root(0, most, missed);
  Shown s;
  s.normal = axis_ * std::cos(t) + sideways(axis_, direction) * std::sin(t);
  s.point_m = ball_.centre_m + s.normal * ball_.radius_m;
  s.cosine = std::max(0.0, std::cos(t + eye_angle(t)));
  s.offset = offset_of(t);
  const Vec2 spread = spread_rad(s.offset);
  s.along_rad = spread.x, s.across_rad = spread.y;
  return s;
}

}  // namespace gonio::probe
