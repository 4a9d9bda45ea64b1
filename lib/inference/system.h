// A problem made ready for linear algebra: whitened residuals (y - f) / sigma, their derivatives, and the small Gram
// matrices of single groups from which every fit, fold, projection and score test of the engine is computed.
//
// Besides parameters there are extra columns: curves over conditions that no simulator knows (free curves, negative
// controls). They enter linearly and only through their Gram matrices.
//
// Each group's blocks are dealt into two halves. A held-out group's nuisance parameters are fitted on one half and
// judged on the other, and the reverse.
//
// Eigen is in this header: rooms above include inference/problem.h and inference/engine.h instead.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "inference/problem.h"
#include "linear/solve.h"

namespace gonio::inference {

// Piecewise linear hats over the quantiles of one condition: a partition of one over the rows to which it applies.
struct CurveBasis {
  std::size_t condition = 0;
  std::vector<double> knots;  // strictly increasing, at least two
  std::size_t size() const { return knots.size(); }
};
CurveBasis curve_basis(const Observations& observations, std::size_t condition, std::size_t knots);

// column_i = sum over parts of direction_i * sum_k coefficient_k hat_k(x_i), on the rows of `groups` (empty: all).
struct ExtraColumn {
  struct Part {
    const CurveBasis* basis = nullptr;
    std::vector<double> coefficients;
  };
  std::vector<Part> parts;
  std::vector<std::size_t> groups;
};

struct Slopes;

class System {
 public:
  System(const Problem& problem, std::uint64_t seed);

  const Problem& problem() const { return problem_; }
  const Observations& observations() const { return problem_.observations(); }
  // In play, ascending; the others do not exist for a fit. A group of which nothing is used, because all of its
  // readings are masked, clipped or set aside, is not in play: nothing can be fitted to it, held out or judged.
  std::vector<std::size_t> groups;

  void set_noise_factor(double factor);
  void set_aside(std::size_t block);
  // Held against predict() + bias from here on. What the bias scatters is in the residuals; weights stay.
  void set_bias(const Bias& bias);
  // Splits blocks into halves anew; the outcome depends on the seed and the block's number only.
  int half(std::size_t row) const { return half_[row]; }
  double weight(std::size_t row) const { return weight_[row]; }  // 1 / sigma, zero where set aside
  std::size_t used_rows(std::size_t group) const;
  bool touches(std::size_t parameter, std::size_t group) const;
  // The only group in play on which it acts, or LinearColumn::everywhere. `on` empty: all.
  std::size_t only_group(const std::vector<std::size_t>& on) const;
  // The same system with nothing but one half of one group in play.
  System restricted(std::size_t group, int half) const;
  double clamped(std::size_t parameter, double value) const;

  // Whitened residuals of one group.
  Eigen::VectorXd residual(std::span<const double> values, std::size_t group) const;
  // Whitened derivatives of f, one column per entry of `columns`; those that `kept` has are taken from there.
  Eigen::MatrixXd jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                           const Slopes* kept = nullptr) const;
  Eigen::MatrixXd extra(std::span<const ExtraColumn* const> columns, std::size_t group) const;
  // y - f for every row of every group, in play or not.
  std::vector<double> raw_residual(std::span<const double> values) const;

 private:
  const Problem& problem_;
  double factor_ = 1;
  std::vector<double> weight_, bias_;
  std::vector<char> half_, aside_;
};

// Sums over one group: for each half the Gram matrix of [columns, residual], whitened.
struct GroupGram {
  std::size_t group = 0;
  std::vector<std::size_t> columns;  // places in Linearisation::columns which touch this group
  std::array<Eigen::MatrixXd, 2> half;
  Eigen::MatrixXd whole() const { return half[0] + half[1]; }
};
struct LinearColumn {
  static constexpr std::size_t everywhere = static_cast<std::size_t>(-1);
  std::size_t parameter = everywhere;          // place in Problem::parameters, or
  std::size_t signature = everywhere;          // differentiated at the point of this signature, or its finite change
  std::size_t extra = everywhere;              // place among the extra columns
  std::size_t local = everywhere;              // the only group it acts on
  double prior_precision = 0, prior_pull = 0;  // 1 / sigma^2 and (start - value) / sigma^2
};
struct Linearisation {
  std::vector<double> values;
  std::size_t own = 0;                // so many columns are parameters differentiated at `values`
  std::vector<LinearColumn> columns;  // the parameters in the order given, then the extra columns
  std::vector<GroupGram> grams;       // one per group in play
};
// Derivatives taken at another point than the residuals: a mechanism whose slope vanishes at its neutral value shows
// its signature where its search starts. Without parameters it is one column: the finite change of the prediction from
// the linearisation's point to `values`, which no slope can stand for where the mechanism is strongly nonlinear.
struct Signature {
  std::vector<double> values;
  std::vector<std::size_t> parameters;
};
// Whitened derivatives that are kept and used again near the point where they were taken: with them a fit moves along
// chords instead of tangents, which costs more steps and no derivatives.
struct Slopes {
  std::vector<std::size_t> parameters;            // ascending
  std::vector<Eigen::MatrixXd> of_group;          // [group]: one column for each of `columns`
  std::vector<std::vector<std::size_t>> columns;  // [group]: places in `parameters` which touch it, ascending
  const double* find(std::size_t parameter, std::size_t group, Eigen::Index rows) const;  // null: not kept
};
// Those that `kept` has are taken from there.
Slopes slopes(const System& system, std::span<const double> values, std::vector<std::size_t> parameters,
              const Slopes* kept = nullptr);

// Columns: `parameters`, then the parameters of `signatures`, then `extras`. `kept`: instead of derivatives at
// `values`, where it has them.
// `of_groups`: receives what group_columns() says of each group in play, where that is worth keeping.
Linearisation linearise(const System& system, std::span<const double> values, std::span<const std::size_t> parameters,
                        std::span<const ExtraColumn> extras = {}, std::span<const Signature> signatures = {},
                        const Slopes* kept = nullptr, std::vector<Eigen::MatrixXd>* of_groups = nullptr);

// The whitened columns of one group themselves, [columns, residual]; `columns` receives their places in the
// linearisation.
Eigen::MatrixXd group_columns(const System& system, const Linearisation& l, std::span<const ExtraColumn> extras,
                              std::span<const Signature> signatures, std::size_t group,
                              std::vector<std::size_t>& columns, const Slopes* kept = nullptr);

// (J'J + priors) x = rhs over a subset of columns, without one group, damped. Nuisance of single groups is eliminated
// group by group (Schur complement); columns are scaled to unit length, so that units do not matter; directions without
// information (gauge freedoms such as albedo times intensity, a held-out group's nuisance) get no step.
class NormalEquations {
 public:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  NormalEquations(const Linearisation& linearisation, const std::vector<std::size_t>& columns,
                  std::size_t without = none, double damping = 0);
  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs) const;       // rows in the order of `columns`
  const Eigen::VectorXd& gradient() const { return gradient_; }  // J'r + prior pull
  const Eigen::VectorXd& diagonal() const { return diagonal_; }

 private:
  struct Local {
    std::vector<Eigen::Index> places;  // in `columns`
    linear::Ldlt factor;
    Eigen::MatrixXd coupling;  // local x shared, scaled
  };
  struct Part {                        // one group's share, restricted to the subset
    std::vector<Eigen::Index> places;  // in `columns`
    Eigen::MatrixXd gram;
    Eigen::VectorXd score;
  };
  static Part part_of(const GroupGram& gram, const std::vector<Eigen::Index>& place_in_subset);
  // Factors the group's own columns and subtracts their Schur complement from the shared system.
  void eliminate(const Part& part, const std::vector<Eigen::Index>& place_in_shared, Eigen::MatrixXd& reduced);

  std::vector<Eigen::Index> shared_;
  std::vector<Local> locals_;
  linear::Ldlt factor_;
  Eigen::VectorXd gradient_, diagonal_, scale_, lift_;  // lift: priors, damping and ridge on the scaled diagonal
};

// J'r + prior pull of all columns.
Eigen::VectorXd downhill(const Linearisation& linearisation);

// Fall of the cost that the linearisation promises for any step along `columns`: 2 g's - s'Hs.
double promised_fall(const Linearisation& linearisation, const std::vector<std::size_t>& columns,
                     const Eigen::VectorXd& step);

// What all groups but one say. Each group's own numbers are eliminated once, then sums over the others are formed by
// halving, so that nothing is subtracted.
struct WithoutGroup {
  Eigen::MatrixXd moved;   // shared columns' steps, one row for each of LeaveOneOut::shared(): towards the foreign
                           // columns and, last, the residual (with the priors' pull)
  Eigen::MatrixXd normal;  // foreign x (foreign, residual): what the model's columns leave of these
};
class LeaveOneOut {
 public:
  // `columns`: the model's; `foreign`: others, which take no step.
  LeaveOneOut(const Linearisation& linearisation, const std::vector<std::size_t>& columns,
              const std::vector<std::size_t>& foreign = {});
  const std::vector<std::size_t>& shared() const { return shared_; }  // the model's columns that are no group's own
  // visit(place in Linearisation::grams, ...), from several threads at once.
  void each(const std::function<void(std::size_t, const WithoutGroup&)>& visit) const;

 private:
  struct Part {                        // of one group
    std::vector<Eigen::Index> places;  // among shared, foreign and residual
    Eigen::MatrixXd matrix;
  };
  void eliminate(const Linearisation& l, const GroupGram& gram, const std::vector<Eigen::Index>& place,
                 const std::vector<char>& own);
  void visit_within(std::size_t first, std::size_t last, Eigen::MatrixXd others,
                    const std::function<void(std::size_t, const WithoutGroup&)>& visit) const;
  WithoutGroup solved(Eigen::MatrixXd sums) const;

  std::vector<std::size_t> shared_;
  Eigen::VectorXd prior_, pull_, scale_;  // of the shared columns
  Eigen::Index size_ = 0;                 // shared, foreign, residual
  std::vector<Part> parts_;
};

}  // namespace gonio::inference
