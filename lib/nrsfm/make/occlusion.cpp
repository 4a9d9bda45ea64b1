// See occlusion.h.
#include "nrsfm/make/occlusion.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/ply.h"
#include "nrsfm/files.h"
#include "nrsfm/make/frame_caster.h"
#include "nrsfm/variables.h"

namespace gonio::nrsfm {
namespace {

FrameMesh read_frame(const std::filesystem::path& file, double unit_m) {
  const io::TriangleMesh read = io::read_ply(file);
  if (read.triangles.empty())
    throw Error(Exit::data, file.string(), "has no triangles", "points alone hide nothing: export a mesh");
  FrameMesh mesh;
  mesh.vertices_m.resize(3, static_cast<Eigen::Index>(read.positions_m.size()));
  for (std::size_t v = 0; v < read.positions_m.size(); ++v) {
    const Vec3 p = read.positions_m[v] * unit_m;
    mesh.vertices_m.col(static_cast<Eigen::Index>(v)) << p.x, p.y, p.z;
  }
  mesh.triangles = read.triangles;
  return mesh;
}

// Columns of `shapes` that are finite throughout.
Shapes without_gaps(const Shapes& shapes) {
  Shapes kept(shapes.rows(), shapes.cols());
  Eigen::Index count = 0;
  for (Eigen::Index p = 0; p < shapes.cols(); ++p)
    if (shapes.col(p).allFinite()) kept.col(count++) = shapes.col(p);
  return kept.leftCols(count);
}

// A ray past the rim of a sheet: what the sheet shows next to the point, outside where nothing is found.
bool outside_beside(const FrameCaster& caster, const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                    double distance, double size) {
  const double aside = 1e-5 * size;
  const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
  for (const Eigen::Vector3d& step : {u, v, Eigen::Vector3d(-u), Eigen::Vector3d(-v)}) {
    const auto met = caster.closest(point - distance * direction + aside * step, direction);
    if (met && std::abs(met->distance_m - distance) < 100 * aside) return met->outside;
  }
  return true;
}

// Tracks of another unit or frame of reference lie elsewhere: the middle of the points is to be within the box of the
// first mesh, and they have an extent.
void require_nearby(const Motion& motion, const std::string& tracks, const std::string& mesh) {
  if (ball_around(motion.points_m).radius_m == 0)
    throw Error(Exit::data, tracks, "has all its points in one place", "they are to be points of a surface");
  const Eigen::Matrix3Xd vertices = motion.mesh(0).vertices_m;
  const Eigen::Vector3d lower = vertices.rowwise().minCoeff(), upper = vertices.rowwise().maxCoeff();
  const Eigen::Vector3d middle = shape_of(motion.points_m, 0).rowwise().mean(), centre = (lower + upper) / 2;
  const double size = (upper - lower).norm(), away = (middle - centre).norm();
  const double spread = (shape_of(motion.points_m, 0).colwise() - middle).colwise().norm().maxCoeff();
  if (away > size || spread > size || spread < 1e-3 * size)
    throw Error(Exit::data, tracks,
                "has points of extent " + shortest_text(2 * spread) + " m, " + shortest_text(away) +
                    " m from the middle of " + mesh + ", which is " + shortest_text(size) + " m large",
                "give both in the same unit and frame of reference");
}

}  // namespace

void add_box(FrameMesh& mesh, const RigBox& box) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.cols());
  mesh.vertices_m.conservativeResize(3, mesh.vertices_m.cols() + 8);
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    mesh.vertices_m.col(first + corner) = box.world_from_box * sign.cwiseProduct(box.half_m);
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : faces) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  }
}

Motion motion_of(DeformingSurface made) {
  const auto surface = std::make_shared<const DeformingSurface>(std::move(made));
  Motion motion;
  motion.points_m = surface->points_m;
  motion.mesh = [surface](Eigen::Index f) {
    FrameMesh mesh{shape_of(surface->vertices_m, f), surface->triangles};
    if (!surface->rig.empty())
      for (const RigBox& box : surface->rig[static_cast<std::size_t>(f)]) add_box(mesh, box);
    return mesh;
  };
  motion.material_m = motion.mesh(0).vertices_m;
  return motion;
}

Motion motion_of(const Animatronic& animatronic, const AnimatronicOptions& options) {
  constexpr Eigen::Index reserve = 4;
  AnimatronicOptions more = options;
  more.points *= reserve;
  Motion motion = motion_of(animatronic.make(more));
  motion.wanted = options.points;
  motion.kind = animatronic.info().id;
  motion.source = "simulated: " + animatronic.info().sentence;
  return motion;
}

Motion motion_of_scans(const std::filesystem::path& meshes, const std::filesystem::path& tracks, double unit_m) {
  const auto files = files_in_order(meshes, ".ply");
  const Shapes shapes = read_reconstruction(tracks).shapes;
  const auto frames = static_cast<Eigen::Index>(files.size());
  if (shapes.rows() != 3 * frames)
    throw Error(Exit::data, tracks.string(),
                "has " + std::to_string(shapes.rows() / 3) + " frames where " + meshes.string() + " has " +
                    std::to_string(frames) + " meshes",
                "name as many meshes as frames");
  Motion motion;
  motion.kind = std::filesystem::absolute(meshes).lexically_normal().parent_path().filename().string();
  if (std::filesystem::is_directory(meshes)) motion.kind = std::filesystem::canonical(meshes).filename().string();
  motion.source = "scans: " + meshes.filename().string();
  motion.points_m = unit_m * without_gaps(shapes);
  const Eigen::Index lost = shapes.cols() - motion.points_m.cols();
  if (lost > 0)
    motion.notes.push_back(std::to_string(lost) + " of " + std::to_string(shapes.cols()) +
                           " points have no place in some frame and are left out");
  if (motion.points_m.cols() < 4)
    throw Error(Exit::data, tracks.string(),
                "has " + std::to_string(motion.points_m.cols()) + " points with a place in every frame",
                "4 is the least");
  motion.files = files;
  motion.files.push_back(tracks);
  motion.mesh = [files, unit_m](Eigen::Index f) { return read_frame(files[static_cast<std::size_t>(f)], unit_m); };
  require_nearby(motion, tracks.string(), files.front().string());
  return motion;
}

Ball ball_around(const Shapes& points_m) {
  Ball ball;
  const Eigen::Map<const Eigen::Matrix3Xd> all(points_m.data(), 3, points_m.size() / 3);
  ball.centre_m = (all.rowwise().minCoeff() + all.rowwise().maxCoeff()) / 2;
  ball.radius_m = (all.colwise() - ball.centre_m).colwise().norm().maxCoeff();
  return ball;
}

Eigen::Array<bool, 1, Eigen::Dynamic> visible_in(const FrameMesh& mesh, const Eigen::Matrix3Xd& points_m,
                                                 const CameraFromObject& camera, Projection projection,
                                                 double tolerance_m, bool one_sided) {
  const FrameCaster caster(mesh);
  const Eigen::Vector3d eye = -camera.rotation.transpose() * camera.translation;
  const Eigen::Vector3d axis = camera.rotation.row(2).transpose();
  const double size = 2 * (mesh.vertices_m.colwise() - mesh.vertices_m.rowwise().mean()).colwise().norm().maxCoeff();
  const double allowed = std::max(tolerance_m, 1e-6 * size);
  Eigen::Array<bool, 1, Eigen::Dynamic> visible(points_m.cols());
  for (Eigen::Index p = 0; p < points_m.cols(); ++p) {
    const Eigen::Vector3d point = points_m.col(p);
    const bool perspective = projection == Projection::perspective;
    const double distance = perspective ? (point - eye).norm() : 2 * size + allowed;
    const Eigen::Vector3d direction = perspective ? Eigen::Vector3d((point - eye) / distance) : axis;
    const auto met = caster.closest(point - distance * direction, direction);
    visible(p) = !met ? !one_sided || outside_beside(caster, point, direction, distance, size)
                      : met->distance_m >= distance - allowed && (met->outside || !one_sided);
  }
  return visible;
}

Visible visible_points(const Motion& motion, const std::vector<CameraFromObject>& cameras, Projection projection) {
  Visible visible(motion.frames(), motion.points_m.cols());
  parallel_for(0, static_cast<std::size_t>(motion.frames()), [&](std::size_t f) {
    const auto frame = static_cast<Eigen::Index>(f);
    visible.row(frame) = visible_in(motion.mesh(frame), shape_of(motion.points_m, frame), cameras[f], projection,
                                    motion.tolerance_m, motion.one_sided);
  });
  return visible;
}

}  // namespace gonio::nrsfm
