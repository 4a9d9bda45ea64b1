// See cloud_file.h.
#include "scan/cloud_file.h"

#include <algorithm>

#include "base/error.h"
#include "geom/covariance.h"
#include "io/ply.h"

namespace gonio::scan {
namespace {

enum : std::size_t { sigma_at, reprojection_at, x_at, y_at, reflected_at, covariance_at };
const io::PlyWish columns{.properties = {"sigma", "reprojection_px", "pixel_x", "pixel_y", "reflected", "cov_xx",
                                         "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"}};

}  // namespace

void write_cloud(const std::filesystem::path& path, const Cloud& cloud,
                 const Rigid<frame::World, frame::Rig>& world_from_rig) {
  io::TriangleMesh mesh;
  io::PlyWish wish = columns;
  const bool several = std::ranges::any_of(cloud.points, [](const ScanPoint& p) { return p.camera != 0; });
  const std::size_t colour_at = wish.properties.size(), camera_at = colour_at + (cloud.colours.empty() ? 0 : 3);
  if (!cloud.colours.empty()) wish.properties.insert(wish.properties.end(), {"red", "green", "blue"});
  if (several) wish.properties.push_back("camera");
  mesh.properties.resize(wish.properties.size());
  for (const std::array<float, 3>& colour : cloud.colours)
    for (std::size_t k = 0; k < 3; ++k) mesh.properties[colour_at + k].push_back(colour[k]);
  for (std::size_t i = 0; several && i < cloud.points.size(); ++i)
    mesh.properties[camera_at].push_back(cloud.points[i].camera);
  const Mat3 turn = matrix_of(world_from_rig.rotation);
  for (const ScanPoint& point : cloud.points) {
    mesh.positions_m.push_back(world_from_rig * point.position_m);
    const double own[] = {point.sigma_m, point.reprojection_px, point.pixel.x, point.pixel.y, double{point.reflected}};
    for (std::size_t k = 0; k < std::size(own); ++k) mesh.properties[k].push_back(static_cast<float>(own[k]));
    const std::array<double, 6> v = turned_covariance(turn, point.covariance);
    for (std::size_t k = 0; k < v.size(); ++k) mesh.properties[covariance_at + k].push_back(static_cast<float>(v[k]));
  }
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
