// How far the predicted pixel of a point of the world may be off, given how well a calibration determines its numbers:
// the projection uncertainty of mrcal (Kogan, http://mrcal.secretsauce.net/uncertainty.html), in closed form.
//
// A point that is fixed in the world is fixed relative to the boards, not to the camera's numbers: when a calibration
// from other noise comes out with other intrinsics, it also places the boards elsewhere. The rigid motion T (small:
// [rotation; shift], about the camera's centre) that takes the boards' points from the one camera frame to the other is
// found by least squares over all points, and the point goes along. With s the shared numbers (lenses, the rig, boards'
// warps), p_i the pose of view i,
//   dp_i = L_i ds + e_i,   cov(e_i) = own_i,             (Placement::slope and own, carried into the camera's frame)
//   dT   = sum_i N_i dp_i + N_w ds = D ds + sum_i N_i e_i,
//   dq   = P_s ds + P_X (dT_rotation x X + dT_shift) = G ds + sum_i M_i e_i,
//   cov(q) = G cov(s) G' + sum_i M_i own_i M_i'.
// Camera frame, metres, pixels. Holds to first order, and for the noise of corners only: what a lens model cannot
// follow is seen by comparing halves of the views (halves.h), not here.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "camera/calibration.h"

namespace gonio::camera {

// One camera of a calibration, with what it was made from.
struct CameraResult {
  const std::vector<View>& views;
  const CalibrationSetup& setup;
  const Calibration& calibration;
  std::size_t camera = 0;

  const Intrinsics& lens() const { return calibration.cameras[camera].lens; }
  int width_px() const { return setup.cameras[camera].width_px; }
  int height_px() const { return setup.cameras[camera].height_px; }
  double noise_px() const { return calibration.cameras[camera].noise_px; }
  bool uses(std::size_t view) const { return views[view].camera == camera && calibration.views[view].weight > 0; }
  const Board& board(std::size_t view) const { return setup.boards[views[view].board].board; }
  const BoardWarp& warp(std::size_t view) const { return calibration.boards[views[view].board].warp; }
};

struct PixelCovariance {  // px^2
  double uu = 0, uv = 0, vv = 0;
  double trace() const { return uu + vv; }
};
// Radius that holds the pixel with 95 %: |d|^2 is referred to a scaled chi-square law with its mean and variance (exact
// for a round and for a one-sided distribution, 1 % in between).
double radius_95(const PixelCovariance& covariance);

struct LinearLaw;  // linear_law.h

class ProjectionLaw {
 public:
  // Throws Error(internal) where the covariance is empty.
  explicit ProjectionLaw(const CameraResult& camera);
  // Of the pixel of a world point that stands at `point_m` in the camera frame, or infinitely far in that direction.
  // Nothing for points that the lens does not show.
  std::optional<PixelCovariance> at(Vec3 point_m, bool infinitely_far = false) const;
  const LinearLaw& linear() const { return *linear_; }

 private:
  Intrinsics lens_;
  std::shared_ptr<const LinearLaw> linear_;
};

}  // namespace gonio::camera
