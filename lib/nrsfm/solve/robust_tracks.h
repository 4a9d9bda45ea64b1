// Robust fit of a solver's model to all tracks; see outliers.h.
//
// What the model leaves out is no outlier. A scale for every frame and perspective are fitted whether the solver has
// them or not (kappa of deforming_model.h: (u - c0) (1 + kappa s q_z) + c0 is what a camera without it would see).
// Beside them a matrix A C of low rank follows what many points have in many frames, such as shapes that the basis
// lacks. It is found by robust principal components (Candes, Li, Ma & Wright, J. ACM 58, 2011): least sum of distances,
// in noise widths, plus sqrt(2F) + sqrt(P) times its nuclear norm, which is the least of (|A|^2 + |C|^2) / 2. Neither
// single observations nor normal noise, whose largest singular value that is, are worth a component.
#pragma once
#include "nrsfm/solve/solved_model.h"

namespace gonio::nrsfm {

class RobustTracks {
 public:
  explicit RobustTracks(const Solved& solved);

  const SolvedModel& model() const { return model_; }
  bool seen(Eigen::Index frame, Eigen::Index point) const { return seen_(frame, point); }  // places in the model
  Eigen::Vector2d track(Eigen::Index frame, Eigen::Index point) const;     // less A C, without perspective
  Eigen::Vector2d residual(Eigen::Index frame, Eigen::Index point) const;  // the same less the model
  double weight(Eigen::Index frame, Eigen::Index point) const { return weight_(frame, point); }
  // Share of an observation's variance that its own weight in the fit has taken: mean of the two coordinates.
  double leverage(Eigen::Index frame, Eigen::Index point) const { return leverage_(frame, point); }
  std::size_t components() const { return static_cast<std::size_t>(a_.cols()); }  // of A C
  double freedom() const;  // degrees of freedom of the residuals, in observations
  // 2F x P of the model's frames and points: tracks that are seen and have a weight, predictions elsewhere, without
  // perspective.
  Eigen::MatrixXd completed() const;

  // Least squares of what is seen and not `outside`.
  void refit(const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& outside);

  // Shape numbers of a point from observations with these weights (zero: not used), and what it predicts in a frame.
  Eigen::VectorXd shape(Eigen::Index point, const Eigen::ArrayXd& weights) const;
  Eigen::Vector2d predicted(Eigen::Index frame, const Eigen::VectorXd& shape) const;

 private:
  Eigen::Matrix<double, 2, Eigen::Dynamic> rows(Eigen::Index frame) const;  // [c_f1 s R .. c_fK s R], upper two rows
  void fit_points();
  void fit_frames();
  void fit_perspective();
  void fit_residual_structure(double ridge);
  void truncate();
  double typical() const;  // one sigma of a coordinate, from the median
  void reweigh(bool least_distances);
  void find_leverages();

  Eigen::Vector2d remainder(Eigen::Index frame, Eigen::Index point) const;  // A C
  double nearness(Eigen::Index frame, Eigen::Index point) const;            // 1 + kappa s q_z
  Eigen::Vector3d place(Eigen::Index frame, Eigen::Index point) const;

  SolvedModel model_;
  double kappa_ = 0;
  Eigen::MatrixXd tracks_, weights_over_time_, shapes_;  // 2F x P; F x K; 3K x P
  Eigen::MatrixXd a_, c_;                                // 2F x q; q x P
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> seen_;
  Eigen::ArrayXXd weight_, leverage_;  // F x P
};

// One sigma of a coordinate: the least of `left` (what the fit leaves), what differences over time leave, and what a
// linear model of generous rank leaves; each is too large where the tracks have structure that it cannot follow.
double noise_of(const Solved& solved, const RobustTracks& fit, double left);

}  // namespace gonio::nrsfm
