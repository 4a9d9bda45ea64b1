// The pattern's plane in pictures (contrast/measure/view_map.h).
#include "contrast/measure/view_map.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "geom/mat3_inverse.h"
#include "linear/svd.h"

namespace gonio::contrast {
namespace {

std::optional<Vec2> mapped(const Mat3& h, Vec2 p) {
  const Vec3 q = h * Vec3{p.x, p.y, 1};
  if (!(std::abs(q.z) > 1e-300)) return std::nullopt;
  return Vec2{q.x / q.z, q.y / q.z};
}

}  // namespace

ViewMap::ViewMap(const camera::CameraModel& camera, const Rigid<frame::Camera, frame::Object>& camera_from_pattern)
    : camera_(camera), camera_from_pattern_(camera_from_pattern), pattern_from_camera_(inverse(camera_from_pattern)) {}

ViewMap::ViewMap(const Mat3& pixel_from_plane)
    : pixel_from_plane_(pixel_from_plane), plane_from_pixel_(inverse(pixel_from_plane)) {}

std::array<double, 4> corner_weights(Vec2 s) {
  return {(1 - s.x) * (1 - s.y), s.x * (1 - s.y), s.x * s.y, (1 - s.x) * s.y};
}

double largest_sigma_px(const CornerCovariance& covariance) {
  double largest = 0;
  for (std::size_t i = 0; i < 8; ++i) largest = std::max(largest, covariance[9 * i]);
  return std::sqrt(largest);
}

ViewMap ViewMap::moved(const CornerShifts& by_px, Vec2 size_m) const {
  ViewMap other = *this;
  other.shifts_px_ = by_px;
  if (shifts_px_)
    for (std::size_t k = 0; k < 4; ++k) (*other.shifts_px_)[k] = (*shifts_px_)[k] + by_px[k];
  other.size_m_ = size_m;
  return other;
}

Vec2 ViewMap::displacement(Vec2 plane_m) const {
  const auto weights = corner_weights({plane_m.x / size_m_.x, plane_m.y / size_m_.y});
  Vec2 sum;
  for (std::size_t k = 0; k < 4; ++k) sum = sum + (*shifts_px_)[k] * weights[k];
  return sum;
}

std::optional<Vec2> ViewMap::pixel(Vec2 plane_m) const {
  const auto at = camera_ ? camera_->project(camera_from_pattern_ * Vec3{plane_m.x, plane_m.y, 0})
                          : mapped(pixel_from_plane_, plane_m);
  if (!at || !shifts_px_) return at;
  return *at + displacement(plane_m);
}

// With displacements: fixed point of p = q^-1(pixel - d(p)); d hardly changes from pixel to pixel, and each round
// leaves about a hundredth of the error.
std::optional<Vec2> ViewMap::plane(Vec2 pixel) const {
  if (!shifts_px_) return unmoved(pixel);
  Vec2 by = displacement(size_m_ * 0.5);
  std::optional<Vec2> at;
  for (int round = 0; round < 3; ++round) {
    at = unmoved(pixel - by);
    if (!at) return at;
    by = displacement(*at);
  }
  return at;
}

std::optional<Vec2> ViewMap::unmoved(Vec2 pixel) const {
  if (!camera_) return mapped(plane_from_pixel_, pixel);
  const camera::Ray ray = camera_->ray(pixel);
  const Vec3 origin = pattern_from_camera_ * ray.origin_m, direction = pattern_from_camera_.rotate(ray.direction);
  if (!(std::abs(direction.z) > 1e-12)) return std::nullopt;
  const double distance = -origin.z / direction.z;
  if (!camera_->orthographic() && distance <= 0) return std::nullopt;
  return Vec2{origin.x + distance * direction.x, origin.y + distance * direction.y};
}

Mat3 homography(const std::array<Vec2, 4>& from, const std::array<Vec2, 4>& to) {
  // Both sides brought to a middle of zero and a size of one, as the equations ask for (Hartley 1997).
  const auto frame = [](const std::array<Vec2, 4>& p) {
    Vec2 middle;
    for (const Vec2 q : p) middle = middle + q * 0.25;
    double size = 0;
    for (const Vec2 q : p) size += norm(q - middle) / 4;
    return std::pair{middle, size > 0 ? size : 1.0};
  };
  const auto [a, sa] = frame(from);
  const auto [b, sb] = frame(to);
  Eigen::Matrix<double, 8, 9> system = Eigen::Matrix<double, 8, 9>::Zero();
  for (int k = 0; k < 4; ++k) {
    const Vec2 p = (from[static_cast<std::size_t>(k)] - a) * (1 / sa);
    const Vec2 q = (to[static_cast<std::size_t>(k)] - b) * (1 / sb);
    system.row(2 * k) << p.x, p.y, 1, 0, 0, 0, -q.x * p.x, -q.x * p.y, -q.x;
    system.row(2 * k + 1) << 0, 0, 0, p.x, p.y, 1, -q.y * p.x, -q.y * p.y, -q.y;
  }
  const Eigen::Matrix<double, 9, 1> h =
      linear::JacobiSvd<Eigen::MatrixXd>(system, Eigen::ComputeFullV).matrixV().col(8);
  Mat3 inner, enter, leave;
  for (int k = 0; k < 9; ++k) inner.m[static_cast<std::size_t>(k)] = h(k);
  enter.m = {1 / sa, 0, -a.x / sa, 0, 1 / sa, -a.y / sa, 0, 0, 1};
  leave.m = {sb, 0, b.x, 0, sb, b.y, 0, 0, 1};
  return leave * inner * enter;
}

}  // namespace gonio::contrast
