// See camera_paths.h. Places p(s), s from 0 to 1, in units of the distance about the centre; e = 20 degrees the height
// of the camera over the horizon, so low that what lies there hides parts of itself:
//   circle        (cos a cos e, sin a cos e, sin e),  a = 2 pi s - pi / 2
//   half-circle   the same,  a = pi s - pi
//   line          (2 s - 1, -cos e, sin e)
//   flyby         (0.35, 2 s - 1, 0.9):  beside the zenith, over the scene and away
//   zigzag        straight strokes between (-1)^k 0.6 to the sides, nearer and farther by turns
//   tricky        towards the scene and back, 1.3 to 0.75, with small motions across
#include "nrsfm/make/camera_paths.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "geom/vector.h"
#include "render/looking_at.h"

namespace gonio::nrsfm {
namespace {

constexpr double height_rad = 20 * pi / 180;

Eigen::Vector3d on_circle(double azimuth_rad) {
  return {std::cos(azimuth_rad) * std::cos(height_rad), std::sin(azimuth_rad) * std::cos(height_rad),
          std::sin(height_rad)};
}

Eigen::Vector3d zigzag(double s) {
  constexpr int strokes = 6;
  const double stroke = std::min(s * strokes, strokes - 1e-12);
  const double part = stroke - std::floor(stroke);
  const auto corner = [](int k) {
    constexpr std::array<double, 3> depth{1.2, 0.8, 1.0};
    const double side = k % 2 == 0 ? -0.6 : 0.6;
    const double reach = depth[static_cast<std::size_t>(k % 3)];
    return Eigen::Vector3d(side, -reach * std::cos(height_rad), reach * std::sin(height_rad));
  };
  const int k = static_cast<int>(stroke);
  return (1 - part) * corner(k) + part * corner(k + 1);
}

Eigen::Vector3d place(const std::string& name, double s) {
  if (name == "circle") return on_circle(2 * pi * s - pi / 2);
  if (name == "half-circle") return on_circle(pi * s - pi);
  if (name == "line") return {2 * s - 1, -std::cos(height_rad), std::sin(height_rad)};
  if (name == "flyby") return {0.35, 2 * s - 1, 0.9};
  if (name == "zigzag") return zigzag(s);
  const double reach = 1.025 + 0.275 * std::cos(2 * pi * s);
  return reach * on_circle(-pi / 2) + Eigen::Vector3d(0.12 * std::sin(4 * pi * s), 0, 0.08 * std::sin(6 * pi * s));
}

CameraFromObject looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& centre) {
  const auto vec = [](const Eigen::Vector3d& v) { return Vec3{v.x(), v.y(), v.z()}; };
  const Mat3 axes = matrix_of(render::looking_at(vec(eye), vec(centre)).rotation);
  CameraFromObject camera;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) camera.rotation(row, column) = axes(column, row);
  camera.translation = -camera.rotation * eye;
  return camera;
}

}  // namespace

const std::vector<std::string>& path_names() {
  static const std::vector<std::string> names{"circle", "half-circle", "line", "flyby", "zigzag", "tricky"};
  return names;
}

std::vector<CameraFromObject> camera_path(const std::string& name, Eigen::Index frames, const PathOptions& options) {
  if (std::ranges::find(path_names(), name) == path_names().end())
    throw Error(Exit::usage, "--path", "no camera path \"" + name + "\"",
                "one of circle, half-circle, line, flyby, zigzag, tricky");
  if (options.distance_m * 0.7 <= options.scene_radius_m)
    throw Error(Exit::usage, "--distance", "leads the camera into the scene", "take at least twice its radius");
  std::vector<CameraFromObject> cameras;
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double s = frames > 1 ? static_cast<double>(f) / static_cast<double>(frames - 1) : 0;
    cameras.push_back(looking(options.centre_m + options.distance_m * place(name, s), options.centre_m));
  }
  return cameras;
}

Tracks project(const Shapes& shapes, const std::vector<CameraFromObject>& cameras, Projection projection,
               const Pinhole& pinhole) {
  const Shapes seen = in_cameras(shapes, cameras);
  Tracks tracks(2 * seen.rows() / 3, seen.cols());
  for (Eigen::Index f = 0; f < seen.rows() / 3; ++f) {
    const auto p = shape_of(seen, f);
    if (projection == Projection::orthographic) {
      tracks.middleRows<2>(2 * f) = p.topRows<2>();
      continue;
    }
    const auto in_front = p.row(2).array() > 0;
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    tracks.row(2 * f) = in_front.select(pinhole.fx_px * p.row(0).array() / p.row(2).array() + pinhole.cx_px, nan);
    tracks.row(2 * f + 1) = in_front.select(pinhole.fy_px * p.row(1).array() / p.row(2).array() + pinhole.cy_px, nan);
  }
  return tracks;
}

}  // namespace gonio::nrsfm
