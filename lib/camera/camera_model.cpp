// Projection and its inverse. The inverse is found by damped Newton steps on the plane of lens_terms.h,
// from the distorted point or, where the radial part alone has moved it far, from the radial solution.
#include "camera/camera_model.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "camera/mechanisms/camera_flat_port.h"
#include "camera/mechanisms/camera_rolling_shutter.h"
#include "camera/mechanisms/lens_non_central.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

void read_orthographic(const manifest::Camera& camera, const std::string& place, Intrinsics& lens) {
  if (!camera.px_per_m.given()) {
    throw Error(Exit::data, place + "/px_per_m", "missing", "give the pixels per metre of an orthographic camera");
  }
  for (const double v : camera.px_per_m.value) {
    if (!(v > 0) || !std::isfinite(v)) throw Error(Exit::data, place + "/px_per_m", "not above 0");
  }
  for (const auto& [name, parameter] : camera.distortion) {
    if (std::ranges::any_of(parameter.value, [](double v) { return v != 0; })) {
      throw Error(Exit::data, place + "/distortion/" + name, "an orthographic camera has no lens", "leave it out");
    }
  }
  lens.fx_px = camera.px_per_m.value.front();
  lens.fy_px = camera.px_per_m.value.back();
  lens.cx_px = camera.cx_px.given() ? camera.cx_px.scalar() : 0.5 * (camera.width_px - 1);
  lens.cy_px = camera.cy_px.given() ? camera.cy_px.scalar() : 0.5 * (camera.height_px - 1);
}

// r with r R(r) = target on the growing branch below `limit`, to a millionth, by Newton's method within brackets;
// nothing where the branch ends earlier.
std::optional<double> radial_inverse(const Intrinsics& lens, double target, double limit) {
  const double* c = lens.distortion.data();
  const double f = c[LensTerm::fisheye];
  double slope = 1;
  const auto radius = [&](double r) {  // the radial part alone, and its slope
    const double w = r * r, k4 = f * c[LensTerm::k4], k5 = (1 - f) * c[LensTerm::k5], k6 = (1 - f) * c[LensTerm::k6];
    const double above = 1 + w * (c[LensTerm::k1] + w * (c[LensTerm::k2] + w * (c[LensTerm::k3] + w * k4)));
    const double below = 1 + w * ((1 - f) * c[LensTerm::k4] + w * (k5 + w * k6));
    const double above_by_w = c[LensTerm::k1] + w * (2 * c[LensTerm::k2] + w * (3 * c[LensTerm::k3] + w * 4 * k4));
    const double below_by_w = (1 - f) * c[LensTerm::k4] + w * (2 * k5 + w * 3 * k6);
    slope = (above + 2 * w * (above_by_w - above * below_by_w / below)) / below;
    return r * above / below;
  };
  double low = 0, high = std::min(limit, std::max(1.0, target));
  while (radius(high) < target) {
    if (high >= limit || high > 1e6) return std::nullopt;
    high = std::min(limit, 2 * high);
  }
  double r = std::min(target, high);
  for (int i = 0; i < 40; ++i) {
    const double missing = target - radius(r);
    if (std::abs(missing) <= 1e-6 * target) break;
    (missing > 0 ? low : high) = r;
    const double next = r + missing / slope;
    r = next > low && next < high ? next : 0.5 * (low + high);
  }
  return r;
}

}  // namespace

CameraModel::CameraModel(const manifest::Camera& camera, const std::string& place)
    : width_px_(camera.width_px), height_px_(camera.height_px) {
  if (width_px_ <= 0 || height_px_ <= 0) {
    throw Error(Exit::data, place + (width_px_ <= 0 ? "/width_px" : "/height_px"), "the image has no pixels",
                "give the size of the image in pixels");
  }
  orthographic_ = !camera_model_info(camera.model, place).perspective;
  if (orthographic_) {
    read_orthographic(camera, place, lens_);
    return;
  }
  lens_ = intrinsics_of(camera, place);
  find_limits();
}

CameraModel::CameraModel(const Intrinsics& lens, int width_px, int height_px)
    : width_px_(width_px), height_px_(height_px), lens_(lens) {
  find_limits();
}

CameraModel CameraModel::parallel(double px_per_m, int width_px, int height_px) {
  CameraModel camera;
  camera.width_px_ = width_px;
  camera.height_px_ = height_px;
  camera.orthographic_ = true;
  camera.lens_ = {px_per_m, px_per_m, 0.5 * (width_px - 1), 0.5 * (height_px - 1), {}};
  return camera;
}

CameraModel CameraModel::with(const Intrinsics& lens) const {
  CameraModel other = *this;
  other.lens_ = lens;
  if (!orthographic_) other.find_limits();
  return other;
}

// Centres of pixels lie at integers: u' + 1/2 = factor (u + 1/2). Rows are read as before, in groups.
CameraModel CameraModel::finer(int factor) const {
  Intrinsics lens = lens_;
  lens.fx_px *= factor, lens.fy_px *= factor;
  lens.cx_px = factor * (lens.cx_px + 0.5) - 0.5, lens.cy_px = factor * (lens.cy_px + 0.5) - 0.5;
  CameraModel other = with(lens);
  other.width_px_ *= factor, other.height_px_ *= factor;
  other.factor_ *= factor;
  return other;
}

CameraModel CameraModel::with_pupil(double pupil_m) const {
  CameraModel other = *this;
  other.pupil_m_ = pupil_m;
  return other;
}

CameraModel CameraModel::with_port(const equation::FlatPort& port) const {
  CameraModel other = *this;
  other.port_ = {port.index, port.distance_m, port.tilt_x_rad, port.tilt_y_rad};
  return other;
}

CameraModel CameraModel::with_motion(Vec2 motion_m) const {
  CameraModel other = *this;
  other.motion_m_ = motion_m;
  return other;
}

Vec3 CameraModel::shift_of_row(double row) const {
  const double tau =
      equation::camera_rolling_shutter((row + 0.5) / factor_ - 0.5, static_cast<double>(height_px_) / factor_);
  return {tau * motion_m_.x, tau * motion_m_.y, 0};
}

void CameraModel::find_limits() {
  distorted_ = std::ranges::any_of(lens_.distortion, [](double v) { return v != 0; });
  radius_limit_ = one_to_one_radius(lens_.distortion.data());
}

std::optional<Vec2> CameraModel::project(Vec3 p) const {
  auto pixel = project_at_rest(p);
  if (motion_m_ == Vec2{}) return pixel;
  for (int i = 0; pixel && i < 50; ++i) {  // v solves v = P_v(p + tau(v) m)
    const double row = pixel->y;
    pixel = project_at_rest(p + shift_of_row(row));
    if (pixel && std::abs(pixel->y - row) < 1e-10) break;
  }
  return pixel;
}

std::optional<Vec2> CameraModel::project_at_rest(Vec3 p) const {
  if (port_[0] != 1 && !orthographic_) p = equation::camera_flat_port({port_[0], port_[1], port_[2], port_[3]}, p);
  if (pupil_m_ != 0) p.z -= equation::lens_non_central_place(pupil_m_, p);
  if (orthographic_) return Vec2{lens_.fx_px * p.x + lens_.cx_px, lens_.fy_px * p.y + lens_.cy_px};
  const std::array<double, 3> direction{p.x, p.y, p.z};
  double x = 0, y = 0;
  if (!lay_on_plane(lens_.distortion[LensTerm::fisheye], direction.data(), &x, &y)) return std::nullopt;
  if (distorted_) {
    if (std::hypot(x, y) > radius_limit_) return std::nullopt;
    const double x0 = x, y0 = y;
    distort(lens_.distortion.data(), x0, y0, &x, &y);
  }
  return Vec2{lens_.fx_px * x + lens_.cx_px, lens_.fy_px * y + lens_.cy_px};
}

Ray CameraModel::ray(Vec2 pixel) const {
  Ray ray = central_ray(pixel);
  if (pupil_m_ != 0 && !orthographic_) ray.origin_m.z += equation::lens_non_central(pupil_m_, ray.direction);
  if (port_[0] != 1 && !orthographic_)
    equation::camera_flat_port_ray({port_[0], port_[1], port_[2], port_[3]}, ray.origin_m, ray.direction);
  if (!(motion_m_ == Vec2{})) ray.origin_m = ray.origin_m - shift_of_row(pixel.y);
  return ray;
}

Ray CameraModel::central_ray(Vec2 pixel) const {
  const Vec2 at{(pixel.x - lens_.cx_px) / lens_.fx_px, (pixel.y - lens_.cy_px) / lens_.fy_px};
  if (orthographic_) return {{at.x, at.y, 0}, {0, 0, 1}};
  const Vec2 p = distorted_ ? undistort(at) : at;
  const double fisheye = lens_.distortion[LensTerm::fisheye];
  if (fisheye == 0) return {{0, 0, 0}, normalized(Vec3{p.x, p.y, 1})};
  const double r = norm(p), theta = std::min(angle_of_radius(fisheye, r), pi);
  const double across = r > 0 ? std::sin(theta) / r : 1;
  return {{0, 0, 0}, normalized(Vec3{across * p.x, across * p.y, std::cos(theta)})};
}

Vec2 CameraModel::undistort(Vec2 target) const {
  const double* c = lens_.distortion.data();
  const auto error = [&](Vec2 p) {
    Vec2 d;
    distort(c, p.x, p.y, &d.x, &d.y);
    return target - d;
  };
  const double radius = norm(target);
  Vec2 p = target;
  if (const auto r = radial_inverse(lens_, radius, radius_limit_); r && radius > 0) p = target * (*r / radius);
  Vec2 e = error(p);
  const double tolerance = 1e-12 * std::max(1.0, radius);
  for (int step = 0; step < 30 && norm(e) > 1e-3 * tolerance; ++step) {
    const auto j = distortion_jacobian(c, p.x, p.y);
    const double det = j[0] * j[3] - j[1] * j[2];
    const Vec2 move{(j[3] * e.x - j[1] * e.y) / det, (j[0] * e.y - j[2] * e.x) / det};
    if (!(std::isfinite(move.x) && std::isfinite(move.y))) break;
    double share = 1;
    Vec2 next = p + move, next_error = error(next);
    while (norm(next_error) >= norm(e) && share > 1e-3) {
      share *= 0.5;
      next = p + move * share;
      next_error = error(next);
    }
    if (norm(next_error) >= norm(e)) break;
    p = next;
    e = next_error;
  }
  return norm(e) <= tolerance && norm(p) <= radius_limit_ ? p : target;
}

}  // namespace gonio::camera
