// Measurements of a body, each a few rows that know the body at two places at most, and a prior that makes it smooth:
// their normal equations, never written out, solved by conjugate gradients (Hestenes & Stiefel 1952).
//
// Unknown: a change of the field's coefficients, and of the globals behind them (index, absorption). With rows whitened
// and the prior a true density, the matrix is the inverse covariance of the answer in Laplace's approximation; draw()
// draws from that by perturbing every row and solving (Papandreou & Yuille 2010, "Gaussian sampling by local
// perturbations").
#pragma once
#include <array>
#include <vector>

#include "base/random.h"
#include "glass/refine/spline_field.h"

namespace gonio::glass {

inline constexpr std::size_t globals = 2;

struct Rows {
  std::uint8_t count = 0, places = 0;
  bool knows_globals = false;
  std::array<SplineField::Support, 2> at{};
  std::array<double, 3> residual{};
  std::array<std::array<double, 4 * 2 + globals>, 3> slopes{};  // value, slope at the first place, the second; globals
};

struct SmoothPrior {
  // Second differences of the coefficients, per cell; pseudo-Huber beyond so many deviations: edges are allowed.
  double bend_sigma = 0.6, bend_width = 1.5;
  double anchor_sigma = 3;  // coefficients from where the stage began, cells
  std::array<double, globals> mean{}, sigma{1, 1};
};

class NormalEquations {
 public:
  NormalEquations(const SplineField& field, const SmoothPrior& prior, std::vector<double> anchor);

  // `state`: coefficients, then globals.
  double prior_cost(const std::vector<double>& state) const;
  void linearise(const std::vector<double>& state, std::vector<Rows> rows);
  // The step for one damping; `promised`: fall of the cost.
  std::vector<double> solve(double damping, double& promised) const;
  // A change drawn from the posterior round the state.
  std::vector<double> draw(Random& random) const;

 private:
  using Column = std::vector<double>;
  Column multiplied(const Column& x) const;
  Column conjugate_gradients(const Column& right, double damping) const;
  template <class Visit>
  void for_bends(const Visit& visit) const;
  void add_rows(const Column& x, Column& to) const;

  const SplineField& field_;
  SmoothPrior prior_;
  Column anchor_, downhill_, diagonal_, ease_;  // ease_: square roots of the bends' weights, in their order
  std::vector<Rows> rows_;
};

}  // namespace gonio::glass
