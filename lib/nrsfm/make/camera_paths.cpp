#include "nrsfm/make/camera_paths.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "base/error.h"
#include "geom/view_path.h"
#include "render/looking_at.h"

namespace gonio::nrsfm {
namespace {

CameraFromObject looking(Vec3 eye, Vec3 centre) {
  const Mat3 axes = matrix_of(render::looking_at(eye, centre).rotation);
  CameraFromObject camera;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) camera.rotation(row, column) = axes(column, row);
  camera.translation = -camera.rotation * Eigen::Vector3d(eye.x, eye.y, eye.z);
  return camera;
}

// At s, 0 to 1, of straight lines between the places, each of which takes as long.
Vec3 place_on(const std::vector<Vec3>& places, double s) {
  const double at = s * static_cast<double>(places.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), places.size() - 1), next = std::min(k + 1, places.size() - 1);
  return places[k] + (at - static_cast<double>(k)) * (places[next] - places[k]);
}

}  // namespace

const std::vector<std::string>& path_names() {
  static const std::vector<std::string> names(view_path_names().begin(), view_path_names().end());
  return names;
}

std::vector<CameraFromObject> camera_path(const std::string& name, Eigen::Index frames, const PathOptions& options) {
  if (options.places.empty()) view_path(name, 0);  // an unknown name is said first
  if (options.distance_m * 0.7 <= options.scene_radius_m)
    throw Error(Exit::usage, "--distance", "leads the camera into the scene", "take at least twice its radius");
  const Vec3 centre{options.centre_m.x(), options.centre_m.y(), options.centre_m.z()};
  std::vector<CameraFromObject> cameras;
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double s = frames > 1 ? static_cast<double>(f) / static_cast<double>(frames - 1) : 0;
    const Vec3 place = options.places.empty() ? view_path(name, s) : place_on(options.places, s);
    cameras.push_back(looking(centre + options.distance_m * place, centre));
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
