// See scan_world.h.
#include "scan/scan_world.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/parallel.h"
#include "base/text.h"
#include "camera/intrinsics.h"

namespace gonio::tests {
namespace {

using Point = std::array<double, 3>;

double depth_of_plane(const ScanWorld& w, double x) {
  const double nearer = w.shape == ScanWorld::Shape::step && x < 0.01 ? 0.012 : 0;
  return w.distance + w.tilt * x - nearer;
}

}  // namespace

Point Pinhole::direction(double x, double y) const {
  const double a = (x - 0.5 * (width - 1)) / f, b = (y - 0.5 * (height - 1)) / f;
  return {a * std::cos(toe_rad) + std::sin(toe_rad), b, -a * std::sin(toe_rad) + std::cos(toe_rad)};
}

std::array<double, 2> Pinhole::pixel(Point p) const {
  const double dx = p[0] - at[0], dy = p[1] - at[1], dz = p[2] - at[2];
  const double x = dx * std::cos(toe_rad) - dz * std::sin(toe_rad), z = dx * std::sin(toe_rad) + dz * std::cos(toe_rad);
  return {f * x / z + 0.5 * (width - 1), f * dy / z + 0.5 * (height - 1)};
}

Point met(const ScanWorld& w, const Pinhole& camera, double x, double y) {
  const Point d = camera.direction(x, y);
  double s = 0;
  if (w.shape == ScanWorld::Shape::ball) {
    const Point o{camera.at[0] - w.ball_x, camera.at[1], camera.at[2] - w.distance};
    const double a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2],
                 c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - w.radius * w.radius, root = b * b - a * c;
    if (root < 0) return {};
    s = (-b - std::sqrt(root)) / a;
  } else {
    for (int k = 0; k < 2; ++k) {  // of a step: the side that the ray ends on
      const double nearer = w.shape == ScanWorld::Shape::step && k == 0 ? 0.012 : 0;
      s = (w.distance - nearer + w.tilt * camera.at[0] - camera.at[2]) / (d[2] - w.tilt * d[0]);
      if (w.shape != ScanWorld::Shape::step || (camera.at[0] + s * d[0] < 0.01) == (k == 0)) break;
    }
  }
  return {camera.at[0] + s * d[0], camera.at[1] + s * d[1], camera.at[2] + s * d[2]};
}

double off_shape(const ScanWorld& w, Point p) {
  if (w.shape == ScanWorld::Shape::ball) return std::hypot(p[0] - w.ball_x, p[1], p[2] - w.distance) - w.radius;
  return (depth_of_plane(w, p[0]) - p[2]) / std::sqrt(1 + w.tilt * w.tilt);
}

std::array<double, 2> lit_by(const ScanWorld& w, const Pinhole& camera, int x, int y) {
  const Point p = met(w, camera, x, y);
  if (p[2] == 0) return {-1e9, -1e9};
  return w.projector.pixel(p);
}

Recorder::Recorder(const ScanWorld& w, const Pinhole& camera, const scan::Sequence& sequence)
    : world_(w), second_(camera.at[0] > 0), width_(camera.width), height_(camera.height), sequence_(sequence) {
  const int places = w.across * w.across;
  lit_.resize(static_cast<std::size_t>(width_ * height_ * places));
  parallel_for(0, static_cast<std::size_t>(height_), [&](std::size_t row) {
    std::size_t at = row * static_cast<std::size_t>(width_ * places);
    for (int x = 0; x < width_; ++x)
      for (int k = 0; k < places; ++k) {
        const double dx = (k % w.across + 0.5) / w.across - 0.5, dy = (k / w.across + 0.5) / w.across - 0.5;
        const Point p = met(w, camera, x + dx, static_cast<double>(row) + dy);
        const auto u = p[2] == 0 ? std::array<double, 2>{-9, -9} : w.projector.pixel(p);
        const bool inside =
            u[0] > -0.5 && u[1] > -0.5 && u[0] < sequence.width_px - 0.5 && u[1] < sequence.height_px - 0.5;
        lit_[at++] = {inside ? u[0] : -9, inside ? u[1] : -9};
      }
  });
}

scan::CameraFrame Recorder::operator()(std::size_t frame) const {
  const ScanWorld& w = world_;
  const auto places = static_cast<std::size_t>(w.across * w.across);
  std::mt19937_64 random(w.seed * 977 + frame * 31 + (second_ ? 7 : 0));
  const bool of_rows = sequence_.frames[frame].axis == scan::Axis::row;
  std::vector<double> shown;
  for (int u = 0; u < (of_rows ? sequence_.height_px : sequence_.width_px); ++u)
    shown.push_back(
        std::pow(std::clamp(scan::light_at(sequence_, frame, of_rows ? 0 : u, of_rows ? u : 0), w.dark, w.bright),
                 w.gamma) /
        places);
  scan::CameraFrame f;
  for (std::size_t i = 0; i < static_cast<std::size_t>(width_ * height_); ++i) {
    double light = 0;
    for (std::size_t k = i * places; k < (i + 1) * places; ++k) {
      if (lit_[k].first < -1) continue;
      const double at = std::clamp<double>(of_rows ? lit_[k].second : lit_[k].first, 0, double(shown.size()) - 1.001);
      const auto u = static_cast<std::size_t>(at);
      light += shown[u] * (1 - (at - double(u))) + shown[u + 1] * (at - double(u));
    }
    double v = w.ambient + w.white * light;
    v = static_cast<double>(std::poisson_distribution<long>(v * w.gain)(random)) / w.gain +
        std::normal_distribution<double>(0, w.read)(random);
    const bool full = v >= 1;
    if (full) v = 1;
    if (w.bits > 0) v = std::round(std::max(0.0, v) * ((1 << w.bits) - 1)) / ((1 << w.bits) - 1);
    f.light.push_back(static_cast<float>(v)), f.saturated.push_back(full);
  }
  return f;
}

scan::Codes decoded(const ScanWorld& w, const Pinhole& camera, const scan::Sequence& sequence, bool noise_stated) {
  scan::DecodeRequest request;
  request.sequence = sequence, request.width = camera.width, request.height = camera.height;
  const Recorder recorder(w, camera, sequence);
  request.read = [&](std::size_t frame) { return recorder(frame); };
  if (noise_stated) request.noise = manifest::Noise{w.gain, w.read};
  return scan::decode(request);
}

scan::Station station_of(const Pinhole& camera) {
  camera::Intrinsics lens;
  lens.fx_px = lens.fy_px = camera.f;
  lens.cx_px = 0.5 * (camera.width - 1), lens.cy_px = 0.5 * (camera.height - 1);
  scan::Station s{camera::CameraModel(lens, camera.width, camera.height), {}};
  s.rig_from_camera.rotation = quaternion_of_rotation_vector({0, camera.toe_rad, 0});
  s.rig_from_camera.translation_m = {camera.at[0], camera.at[1], camera.at[2]};
  return s;
}

std::string manifest_of(const ScanWorld& w) {
  std::string cameras, rig;
  const Pinhole* all[] = {&w.left, &w.right, &w.projector};
  const char* names[] = {"left", "right", "projector"};
  for (int k = 0; k < 3; ++k) {
    const Pinhole& c = *all[k];
    cameras += format(
        "%s\"%s\": {\"model\": \"pinhole\", \"width_px\": %d, \"height_px\": %d, \"fx_px\": %.17g, \"fy_px\": %.17g, "
        "\"cx_px\": %.17g, \"cy_px\": %.17g}",
        k > 0 ? ", " : "", names[k], c.width, c.height, c.f, c.f, 0.5 * (c.width - 1), 0.5 * (c.height - 1));
    rig += format(
        "%s{\"camera\": \"%s\", \"rig_from_camera\": {\"rotation\": [%.17g, 0, %.17g, 0], \"translation_m\": "
        "[%.17g, %.17g, %.17g]}}",
        k > 0 ? ", " : "", names[k], std::cos(c.toe_rad / 2), std::sin(c.toe_rad / 2), c.at[0], c.at[1], c.at[2]);
  }
  return "{\"gonio\": 1, \"cameras\": {" + cameras + "}, \"rigs\": {\"rig\": {\"cameras\": [" + rig + "]}}}";
}

}  // namespace gonio::tests
