// The matrices behind ProjectionLaw. For sources of this folder only: the types are Eigen's.
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "camera/quality/projection_law.h"

namespace gonio::camera {

// A shared number as a direction in the columns of BoardColumn: two of them where the aspect ratio is held, none where
// it does not move this camera's pixels of this board at a given pose.
using Direction = std::vector<std::pair<std::size_t, double>>;
std::vector<Direction> directions(const CameraResult& camera, std::size_t board);

struct LinearLaw {
  std::vector<Direction> columns;       // of the shared numbers, in the calibration's order; of no board
  Eigen::MatrixXd shared;               // their covariance
  Eigen::MatrixXd drift;                // 6 x shared: D
  Eigen::Matrix<double, 6, 6> scatter;  // sum N_i own_i N_i'
  Eigen::Matrix<double, 6, 6> normal;   // of the rigid motion's least squares, over all points
};

// What a view's points add to the rigid motion's least squares: [its normal matrix, right-hand side by the view's
// pose].
struct AlignmentPart {
  Eigen::Matrix<double, 6, 6> normal, by_pose;
  Eigen::Matrix<double, 6, 2> by_warp;
};
AlignmentPart alignment_part(const Board& board, const BoardPose& pose, const BoardWarp& warp,
                             const std::vector<Vec2>& board_points_m);

// The same right-hand side by the warps among the shared numbers.
void add_warp(const std::vector<SharedParameter>& shared, std::size_t board, const AlignmentPart& part,
              Eigen::MatrixXd& by_shared);

// What a change of the shared numbers, and of the rigid motion, does to the pixel of a point; false where it is not
// seen.
struct PixelDerivatives {
  Eigen::MatrixXd by_shared;  // 2 x shared: G, the motion that follows from it included
  Eigen::Matrix<double, 2, 6> by_motion;
};
bool pixel_derivatives(const Intrinsics& lens, const LinearLaw& law, Vec3 point_m, bool infinitely_far,
                       PixelDerivatives& d);

// One view's part in the normal equations, at weights of one over the noise's variance: B (shared x 6), C (6 x 6), and
// A (shared x shared).
struct ViewEquations {
  Eigen::MatrixXd a, b;
  Eigen::Matrix<double, 6, 6> c;
};
// `weights`: one per point, 1 / px^2.
ViewEquations view_equations(const Intrinsics& lens, const BoardPose& pose, const Board& board, const BoardWarp& warp,
                             const std::vector<Direction>& columns, const std::vector<Vec2>& board_points_m,
                             const std::vector<double>& weights);

}  // namespace gonio::camera
