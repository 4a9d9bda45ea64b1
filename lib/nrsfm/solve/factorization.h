// What factorization methods have in common. W is 2F x P, its translation removed; W = M B with M 2F x 3K.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

using CameraRows = Eigen::Matrix<double, 2, 3>;

// Tracks less each frame's mean over its visible points; missing entries become 0.
struct Centred {
  Eigen::MatrixXd w;            // 2F x P
  Eigen::VectorXd translation;  // 2F
};
Centred centred(const Sequence& sequence);

// The 2F x 3K left factor U sqrt(s) of W's truncated singular value decomposition, in falling order of s.
Eigen::MatrixXd motion_rows(const Eigen::MatrixXd& w, Eigen::Index terms);

// Noise of tracks, one sigma, from their third differences over time (variance 20 sigma^2; median): too large where
// they move fast from frame to frame.
double noise_of(const Eigen::MatrixXd& w);

// The least K that leaves outside the first 3K singular values at most `share` of the tracks' root mean square, or no
// more than their noise; at most `most`, and never more than P / 3 and 2F / 3 allow.
Eigen::Index rank_of(const Eigen::MatrixXd& w, double share, Eigen::Index most);

// The rotations R_f and scales s_f of a motion matrix of rank 3K, by its 3K x 3 corrective transform G:
//   M_f G = s_f R_f,   so that   M_f G G' M_f' = s_f^2 I      (Xiao et al. 2004; Akhter et al. 2008, section 4)
// three equations per frame for G up to a rotation or reflection on its right. The landscape of the squared residuals
// has many minima. The way to the lowest goes by way of ranks: K = 1 is linear in Q = G G' (Tomasi & Kanade 1992);
// each minimum of rank K, padded by zeros, and perturbations of it (seeded) start Levenberg-Marquardt at rank K + 1,
// and the two lowest minima go on. Rows have to be in falling order of importance, as motion_rows() gives them.
struct UpgradeOptions {
  bool free_scales = false;  // s_f = 1 for all f otherwise
  std::uint64_t seed = 0;
};
struct Upgrade {
  Eigen::MatrixXd transform;          // 3K x 3
  std::vector<CameraRows> rotations;  // orthonormal rows
  Eigen::VectorXd scales;             // F, > 0; their mean is 1
  double residual = 0;                // rms of the three equations of a frame, over s_f^2
};
// Error(data) where frames do not determine a metric (motion without rotation out of the image's plane).
Upgrade metric_upgrade(const Eigen::MatrixXd& rows, const UpgradeOptions& options = {});
// The best of each rank on the way, of the first 3, 6, .. 3K columns.
std::vector<Upgrade> metric_upgrades(const Eigen::MatrixXd& rows, const UpgradeOptions& options = {});

// F x K orthonormal DCT-II basis of trajectories; column 0 is constant.
Eigen::MatrixXd dct_basis(Eigen::Index frames, Eigen::Index terms);

// Nearest 2 x 3 (3 x 3) matrix with orthonormal rows (a proper rotation).
CameraRows nearest_rows(const CameraRows& a);
Eigen::Matrix3d completed(const CameraRows& rows);

// The camera that sees `shape` (3 x P) as `tracks` (2 x P, used where visible): s R x + t, least squares, from `start`.
// `spread` Q adds s^2 trace(R Q R') to the sum: the shape's uncertainty, summed over points.
struct WeakCamera {
  CameraRows rotation = CameraRows::Identity();
  double scale = 1;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();
};
WeakCamera fit_camera(const Eigen::Matrix2Xd& tracks, const Eigen::Array<bool, 1, Eigen::Dynamic>& visible,
                      const Eigen::Matrix3Xd& shape, const WeakCamera& start, bool free_scale,
                      const Eigen::Matrix3d& spread = Eigen::Matrix3d::Zero());

// Low-rank completion of missing entries, W ~ A B + t 1', rank r at most: variational principal components, from tracks
// interpolated over time. What few frames or points support stays near the mean; least squares would run away there.
struct Completion {
  Eigen::MatrixXd w;            // 2F x P, less the translation; measured entries stay as measured
  Eigen::VectorXd translation;  // 2F
  int iterations = 0;
  bool converged = false;
};
Eigen::MatrixXd interpolated(const Sequence& sequence);  // over time; ends are held
// Error(data) where a point is seen in fewer than 2 frames, or a frame sees fewer than 4 points.
Completion complete(const Sequence& sequence, Eigen::Index rank, int most_iterations = 150);
// The K <= most at which completion at rank 3K best predicts visible entries that were held out (5 %); a larger one has
// to be better by a fifth, and the first that predicts as well as rank_of() asks is enough.
Eigen::Index completion_rank(const Sequence& sequence, double share, Eigen::Index most);
// Error(data) where a point is seen in fewer frames, or a frame sees fewer points, than least squares of that rank
// need.
void require_seen(const Sequence& sequence, Eigen::Index rank);

// Shapes of a rank-3K model: S_f = sum_k c_fk B_k.
Shapes shapes_of(const Eigen::MatrixXd& coefficients, const Eigen::MatrixXd& basis);  // F x K, 3K x P

// What solvers with rotations from the tracks alone begin with.
struct Start {
  Eigen::MatrixXd w;            // 2F x P, completed, less the translation
  Eigen::VectorXd translation;  // 2F
  Upgrade upgrade;
  Eigen::MatrixXd rows;  // 2F x 3: s_f R_f
};
Start start_from(const Sequence& sequence, Eigen::Index terms, const UpgradeOptions& options);
Start centred_start(const Sequence& sequence, Eigen::Index terms);  // without cameras: complete at rank 3 `terms`
void take_cameras(Start& start, const Upgrade& upgrade);

// The whole sequence turned so that the first frame's camera is the frame of reference.
void turn_to_first_camera(Reconstruction& reconstruction);

}  // namespace gonio::nrsfm
