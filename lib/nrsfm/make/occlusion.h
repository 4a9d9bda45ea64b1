// What deforms before the virtual cameras, simulated or scanned, and which of its points they see.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "nrsfm/make/animatronic.h"

namespace gonio::nrsfm {

struct FrameMesh {
  Eigen::Matrix3Xd vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

void add_box(FrameMesh& mesh, const RigBox& box);

struct Motion {
  std::string kind;             // level of the factor "deformation"
  std::string source;           // what deforms
  Shapes points_m;              // 3F x P, the first ones preferred
  Eigen::Index wanted = 0;      // points that a sequence is to have, the others stand by; 0: all of them
  Eigen::Matrix3Xd material_m;  // of every vertex: a place that it keeps; empty where meshes differ between frames
  std::function<FrameMesh(Eigen::Index)> mesh;  // of a frame; safe from many threads
  double tolerance_m = 0;  // points may lie this far behind the surface: scans and tracks that differ
  bool one_sided = false;  // from behind a sheet its points are hidden, too; else they show on both sides
  std::vector<std::string> notes;
  std::vector<std::filesystem::path> files;  // that it was read from
  Eigen::Index frames() const { return points_m.rows() / 3; }
};
// The surface with its rig. Of an animatronic four times as many points as are wanted stand by, since a path may never
// see some.
Motion motion_of(const Animatronic& animatronic, const AnimatronicOptions& options);
Motion motion_of(DeformingSurface surface);
// Scans: a folder or pattern of PLY meshes, one per frame in the order of their names, and the points that are followed
// on them (files.h: read_reconstruction). Points without a place in some frame are left out, and a note says how many.
// Error(data | no_input) where they do not fit.
Motion motion_of_scans(const std::filesystem::path& meshes, const std::filesystem::path& tracks, double unit_m);

// Centre and radius of a sphere about all points of all frames.
struct Ball {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0;
};
Ball ball_around(const Shapes& points_m);

// Whether the ray from the camera (parallel to its axis where orthographic) reaches each point before it meets the
// surface, or meets it no more than `tolerance_m` earlier.
Eigen::Array<bool, 1, Eigen::Dynamic> visible_in(const FrameMesh& mesh, const Eigen::Matrix3Xd& points_m,
                                                 const CameraFromObject& camera, Projection projection,
                                                 double tolerance_m = 0, bool one_sided = false);
// Of all frames, F x P: Jensen et al. 2018, algorithm 3.
Visible visible_points(const Motion& motion, const std::vector<CameraFromObject>& cameras, Projection projection);

}  // namespace gonio::nrsfm
