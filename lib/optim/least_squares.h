// Least squares of dense problems of up to some hundred parameters: bounds, Gaussian priors, a robust loss, and the
// covariance of what is found.
//
//   minimise  sum over groups of rho(|r_g(x)|^2)  +  sum ((x_k - mean_k) / sigma_k)^2      lower <= x <= upper
//
// Residuals are whitened: divided by their standard deviation. The loss is applied by iteratively reweighted squares.
// A parameter that presses against a bound is held there; what is left takes the full step (Kanzow, Yamashita &
// Fukushima 2004 for the projection). Slopes that a model does not state are central differences.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "optim/descent.h"

namespace gonio::optim {

// What is fitted. Parameters are plain numbers, or hold rotations and the like: then moved() says what a small change
// of `freedoms` numbers does to them, slopes are by that change, and so is the covariance.
class Model {
 public:
  // False where the model has no value.
  virtual bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) const = 0;
  virtual Eigen::Index freedoms(const Eigen::VectorXd& x) const { return x.size(); }
  virtual Eigen::VectorXd moved(const Eigen::VectorXd& x, const Eigen::VectorXd& change) const { return x + change; }
  // d residuals / d change at x, where the residuals are r.
  virtual Eigen::MatrixXd slopes(const Eigen::VectorXd& x, const Eigen::VectorXd& r) const;
  // Step of a central difference by change k; by default 6e-6 of the parameter, or 6e-6 where that is zero.
  virtual double difference(const Eigen::VectorXd& x, Eigen::Index k) const;

 protected:
  ~Model() = default;
};

enum class Loss { squares, huber, cauchy };  // rho(s) = s; 2 w sqrt(s) - w^2 beyond w; w^2 log(1 + s / w^2)

struct Prior {
  Eigen::Index parameter = 0;
  double mean = 0, sigma = 1;
};

// Bounds and priors are of plain numbers: of models that do not override moved().
struct Terms {
  Eigen::VectorXd lower, upper;  // empty: none
  std::vector<Prior> priors;
  Loss loss = Loss::squares;
  double width = 3;        // w of the loss
  Eigen::Index group = 1;  // residuals that the loss takes as one: 2 of a pixel
};

struct Fit {
  Eigen::VectorXd x;
  double cost = 0;
  Descended descended;
  std::vector<Eigen::Index> held;  // at a bound
  // Inverse of J'WJ with the priors, for residuals of variance 1 (times cost over degrees where that is not known);
  // zero for what is held, infinite on the diagonal for what the residuals do not determine.
  Eigen::MatrixXd covariance;
  bool determined = true;
};

// Error(internal) where the model has no value at `start`, clamped to the bounds.
Fit fit(const Model& model, Eigen::VectorXd start, const Terms& terms = {}, const Limits& limits = {});

}  // namespace gonio::optim
