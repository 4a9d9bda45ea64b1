// Tracks of a shape that deforms, as the model of an orthographic solver predicts them, and what it may leave out.
//
//   S_fp = sum_k c_fk b_kp,   c = Omega X        shapes: K per point, their weights smooth over time or fixed
//   q = R_f S_fp,             R_f = exp([w_f]x) R0_f     camera's axes: x right, y down, z forward
//   u = c0 + U / (1 + kappa s_f q_z),   U = s_f (q_x, q_y) + t_f - c0,   s_f = exp(l_f),   sum_f l_f = 0
//
// kappa = 0 is (weak) perspective: every point as far away as the shape's origin (Hartley & Zisserman 2004, section
// 6.3); l = 0 one scale for all frames. c0: where the camera looks. To first order the perspective adds -kappa s U q_z.
// What c0 is does not matter much: another one adds to U a constant, and kappa s q_z times that is a small turn.
//
// Units: tracks' for u, t, c0 and, as the scales' mean is 1, for S; kappa is one over the focal length, 1 / unit.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "nrsfm/sequence.h"
#include "nrsfm/solve/followed.h"

namespace gonio::nrsfm {

// A solver's answer in the form above; `frames` and `points` say which of the sequence's take part.
struct SolvedModel {
  std::vector<Eigen::Index> frames, points;
  std::vector<Eigen::Matrix3d> rotation;                    // R0, one per frame that takes part
  Eigen::Matrix2Xd translation;                             // t
  Eigen::VectorXd log_scale;                                // l
  Eigen::MatrixXd omega;                                    // frames that take part x d
  Eigen::MatrixXd x;                                        // d x K
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> held;  // d x K: entries of X that the solver's model fixes
  std::vector<Eigen::MatrixXd> basis;                       // b: 3 x K, one per point that takes part
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();         // c0

  Eigen::Index terms() const { return x.cols(); }
  Eigen::Index frame_count() const { return static_cast<Eigen::Index>(frames.size()); }
  Eigen::Index point_count() const { return static_cast<Eigen::Index>(points.size()); }
};

Layout layout_of(const SolvedModel& model);

class DeformingModel {
 public:
  explicit DeformingModel(SolvedModel start);

  const SolvedModel& start() const { return start_; }
  const Layout& layout() const { return layout_; }
  // The start as a vector of parameters; kappa is 0.
  std::vector<double> values() const;

  struct Frame {
    Eigen::Matrix3d rotation, turned;  // R; left Jacobian of w
    Eigen::Vector2d shift;
    double scale = 1;
    Eigen::VectorXd weights;  // c_f
  };
  // What the parameters say of all frames that take part.
  std::vector<Frame> frames(std::span<const double> values) const;
  // Where `point` is seen in the frames listed in `seen` (places among those that take part): two numbers each.
  void predict(std::span<const double> values, std::size_t point, std::span<const Eigen::Index> seen,
               std::span<double> prediction) const;
  // Derivatives of these with respect to `columns`, column after column.
  void jacobian(std::span<const double> values, std::size_t point, std::span<const Eigen::Index> seen,
                std::span<const std::size_t> columns, std::span<double> derivatives) const;
  // Of one point in one frame, in the camera's axes, times the frame's scale.
  Eigen::Vector3d in_camera(std::span<const double> values, const Frame& frame, std::size_t point) const;

 private:
  Eigen::Map<const Eigen::Matrix3Xd> shapes(std::span<const double> values, std::size_t point) const;
  Eigen::MatrixXd weights(std::span<const double> values) const;
  struct Slopes;
  void fill_column(std::span<const double> values, std::size_t column, std::size_t point,
                   std::span<const Eigen::Index> seen, const std::vector<Frame>& frames,
                   const std::vector<Slopes>& slopes, std::span<double> derivative) const;

  SolvedModel start_;
  Layout layout_;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> free_weights_;  // entries of X that are not held
};

}  // namespace gonio::nrsfm
