// Least squares of the model of deforming_model.h to tracks, all of it at once: turns and translations of frames,
// weights of the shapes free in every frame (which hold the frames' scales), the shapes of all points, and kappa or
// not.
//
//   q_fp = R_f sum_k c_fk b_kp,   u_fp = c0 + (q_xy + t_f - c0) / (1 + kappa q_z)
//
// Levenberg-Marquardt with the points eliminated: their numbers are not damped and follow every step of the frames by
// themselves, as in variable projection, without which the valley between weights and shapes is not walked to its end
// (Hong & Fitzgibbon, ICCV 2015). Per step one system of F (5 + K) + 1 numbers.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace gonio::nrsfm {

struct UsedTracks {
  Eigen::MatrixXd tracks;  // 2F x P; anything where not used
  Eigen::ArrayXXd used;    // F x P: 1 or 0
};

struct DeformingShape {
  std::vector<Eigen::Matrix3d> rotation;  // R, F
  Eigen::Matrix2Xd shift;                 // t, 2 x F
  Eigen::MatrixXd weights;                // c, F x K
  Eigen::MatrixXd basis;                  // b, 3K x P, shape after shape
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double kappa = 0;

  Eigen::Index terms() const { return weights.cols(); }
  Eigen::Vector3d place(Eigen::Index frame, Eigen::Index point) const;  // q
  // Largest distance of a point along the line of sight from the frame's middle, at the scale that the middle is seen
  // with: all points may stand farther away, and be larger.
  double depth() const;
};

// Tracks less predictions; 0 where not used.
Eigen::MatrixXd residuals(const UsedTracks& tracks, const DeformingShape& shape);

struct DeformingFitOptions {
  bool perspective = false;  // kappa is free; otherwise it stays where it stands
  int most_steps = 40;
  double tolerance = 1e-4;  // relative fall of the squares that is worth another step
};
struct DeformingFit {
  DeformingShape shape;
  double squares = 0;
  int steps = 0;
};
DeformingFit fit_deforming(const UsedTracks& tracks, DeformingShape start, const DeformingFitOptions& options);

// d u / d kappa at a fit, 2F x P, whole and less what all other numbers can imitate.
struct PerspectiveColumn {
  Eigen::MatrixXd whole, surviving;
};
PerspectiveColumn perspective_column(const UsedTracks& tracks, const DeformingShape& shape);

// One shape more, which takes up as much of the residuals as it can while all else stands still.
DeformingShape with_further_shape(const UsedTracks& tracks, DeformingShape shape);

}  // namespace gonio::nrsfm
