// The adjustment over everything: poses of pieces, true places of markers (prior: the tomograph's), poses of cameras
// (prior: theirs), optionally one scale. For sources of this folder.
//
//   minimise  sum |L^-1 r(sighting)|^2 + sum |y_k|^2 + sum |z_v|^2
//
// where marker k lies at m_k + L_k y_k in its piece and camera v has moved by L_v z_v from its given pose: L L' are the
// stated covariances, so that a camera whose pose is uncertain shifts all that it sees together, and one of which a
// direction is known exactly does not move along it. A half angle pulls linearly beyond size_width deviations. Markers
// are eliminated (Schur complement); what is solved has 6 numbers a piece and a camera.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "optim/descent.h"
#include "reassembly/bundle_sight.h"

namespace gonio::reassembly {

struct AdjustedSight {
  std::size_t view = 0;
  Sight sight;         // by the camera's given pose
  Sighting sighting;   // which it is
  bool used = true;    // false: contradicts the rest
  double square = 0;   // of its axis' whitened residual, after the adjustment
  double miss_px = 0;  // and that residual in pixels; 0 where their size is not known
  bool seen_px = false;
};
struct AdjustedMarker {
  std::size_t piece = 0;
  Eigen::Vector3d prior = Eigen::Vector3d::Zero();
  Eigen::Matrix3d root = Eigen::Matrix3d::Zero();  // L of the tomograph's covariance
  std::optional<double> radius;
  double start_radius = 0;  // where it is not known
  std::vector<AdjustedSight> sights;
  // A point that was measured otherwise, without sightings.
  std::optional<Eigen::Vector3d> point;
  Eigen::Matrix3d point_white = Eigen::Matrix3d::Identity();  // inverse root of its covariance
  bool used = true;
  // After the adjustment:
  Eigen::Vector3d y = Eigen::Vector3d::Zero();
  double radius_now = 0;
  double chi_square = 0;
  int degrees = 0;                                                            // of its residuals, its place not counted
  Eigen::Matrix<double, 6, 1> without = Eigen::Matrix<double, 6, 1>::Zero();  // motion of its piece if it were left out
  bool needed = false;                                                        // nothing would hold the piece without it
};
struct AdjustedPiece {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d place;
  Eigen::Vector3d anchor;  // object frame: mean of its markers
  Matrix6 covariance;      // rotation vector, place, at the anchor's place in the world
};
struct Adjusted {
  std::vector<AdjustedPiece> pieces;
  std::vector<AdjustedMarker> markers;
  std::vector<Eigen::Matrix<double, 6, 1>> cameras;  // motion L z of each view
  bool free_scale = false;
  double scale = 1, sigma_scale = 0;
  double chi_square = 0;
  optim::Descended descended;
};
void adjust(Adjusted& all, const std::vector<Matrix6>& camera_covariance);

}  // namespace gonio::reassembly
