// See cloud_file.h.
#include "scan/cloud_file.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "geom/covariance.h"
#include "io/ply.h"

namespace gonio::scan {
namespace {

enum : std::size_t { sigma_at, reprojection_at, x_at, y_at, reflected_at, covariance_at };
const io::PlyWish columns{.properties = {"sigma", "reprojection_px", "pixel_x", "pixel_y", "reflected", "cov_xx",
                                         "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"}};

constexpr std::size_t points_at_once = 1 << 14;

}  // namespace

void write_cloud(const std::filesystem::path& path, const Cloud& cloud,
                 const Rigid<frame::World, frame::Rig>& world_from_rig) {
  io::TriangleMesh mesh;
  io::PlyWish wish = columns;
  const bool several = std::ranges::any_of(cloud.points, [](const ScanPoint& p) { return p.camera != 0; });
  const std::size_t colour_at = wish.properties.size(), camera_at = colour_at + (cloud.colours.empty() ? 0 : 3);
  if (!cloud.colours.empty()) wish.properties.insert(wish.properties.end(), {"red", "green", "blue"});
  if (several) wish.properties.push_back("camera");
  const std::size_t count = cloud.points.size();
  mesh.positions_m.resize(count);
  mesh.properties.assign(wish.properties.size(), std::vector<float>(count));
  const Mat3 turn = matrix_of(world_from_rig.rotation);
  parallel_for(0, (count + points_at_once - 1) / points_at_once, [&](std::size_t n) {
    for (std::size_t i = n * points_at_once; i < std::min(count, (n + 1) * points_at_once); ++i) {
      const ScanPoint& p = cloud.points[i];
      mesh.positions_m[i] = world_from_rig * p.position_m;
      const double own[] = {p.sigma_m, p.reprojection_px, p.pixel.x, p.pixel.y, double{p.reflected}};
      for (std::size_t k = 0; k < std::size(own); ++k) mesh.properties[k][i] = static_cast<float>(own[k]);
      const std::array<double, 6> v = turned_covariance(turn, p.covariance);
      for (std::size_t k = 0; k < v.size(); ++k) mesh.properties[covariance_at + k][i] = static_cast<float>(v[k]);
      for (std::size_t k = 0; k < 3 && !cloud.colours.empty(); ++k)
        mesh.properties[colour_at + k][i] = cloud.colours[i][k];
      if (several) mesh.properties[camera_at][i] = p.camera;
    }
  });
  io::write_ply(path, mesh, wish);
}

std::vector<ScanPoint> read_cloud(const std::filesystem::path& path,
                                  const Rigid<frame::World, frame::Rig>& world_from_rig) {
  const io::TriangleMesh mesh = io::read_ply(path, columns);
  for (std::size_t k = 0; k < columns.properties.size(); ++k)
    if (mesh.properties[k].empty())
      throw Error(Exit::data, path.string(), "has no property " + columns.properties[k],
                  "give a cloud that structured-light wrote: a point's pixel and errors stand beside it");
  const Rigid<frame::Rig, frame::World> rig_from_world = inverse(world_from_rig);
  const Mat3 turn = matrix_of(rig_from_world.rotation);
  std::vector<ScanPoint> points(mesh.positions_m.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto value = [&](std::size_t k) { return double{mesh.properties[k][i]}; };
    ScanPoint& p = points[i];
    p.position_m = rig_from_world * mesh.positions_m[i];
    p.sigma_m = value(sigma_at), p.reprojection_px = value(reprojection_at);
    p.pixel = {value(x_at), value(y_at)}, p.reflected = mesh.properties[reflected_at][i];
    std::array<double, 6> v{};
    for (std::size_t k = 0; k < v.size(); ++k) v[k] = value(covariance_at + k);
    p.covariance = turned_covariance(turn, v);
  }
  return points;
}

}  // namespace gonio::scan
