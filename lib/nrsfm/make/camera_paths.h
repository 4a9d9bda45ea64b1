// What virtual cameras see on the six paths of Jensen et al. 2018, figure 4 (geom/view_path.h).
// And on paths that an instrument went.
#pragma once
#include <string>
#include <vector>

#include "geom/vector.h"
#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

const std::vector<std::string>& path_names();

struct PathOptions {
  double distance_m = 1;  // of the camera's mean place from the scene's centre
  double scene_radius_m = 0.2;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  // Instead of a path by name: where the camera stands, about the centre, in units of its mean distance; straight lines
  // between.
  std::vector<Vec3> places{};
};
// One camera for each frame, looking at the centre. Error(usage) for unknown names.
std::vector<CameraFromObject> camera_path(const std::string& name, Eigen::Index frames, const PathOptions& options);

// Tracks of shapes (object frame): orthographic in metres; perspective in pixels.
Tracks project(const Shapes& shapes, const std::vector<CameraFromObject>& cameras, Projection projection,
               const Pinhole& pinhole);

}  // namespace gonio::nrsfm
