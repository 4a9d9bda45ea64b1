// What mechanisms, free curves and negative controls look like in the recordings once the free parameters of a model
// are projected out: isolability, the null test and location all read from this projection.
#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "inference/engine.h"
#include "inference/fit.h"
#include "stats/sign_flip.h"

namespace gonio::inference {

// One thing that could structure the residuals: a mechanism, the finite change that it makes at another point than its
// start, a curve over one condition, or a negative control.
struct Structure {
  enum class Kind { mechanism, change, curve, negative_control };
  Kind kind = Kind::mechanism;
  std::size_t index = 0;  // candidate, condition, or number of the negative control
  std::string name;
  std::size_t first = 0, count = 0;  // its columns among all signature parameters, or among all extras
  std::size_t shape = 0;             // negative controls: the candidate whose freedom it has
  std::vector<double> point{};       // changes: the values of the candidate's parameters
  double period = 0;                 // of a curve that is a wave in each group; 0: one smooth curve for all
};

// The columns of all structures, as extras and signatures that linearise() understands. Not copyable: extras point at
// bases.
class Structures {
 public:
  Structures() = default;
  Structures(const Structures&) = delete;
  Structures& operator=(const Structures&) = delete;
  void add_mechanism(const System& system, const std::vector<double>& values, std::size_t candidate);
  // Finite changes at several points within the bounds, where the slopes at the start do not span them: what a strongly
  // nonlinear mechanism could do elsewhere. Mechanisms that all groups share.
  void add_changes(const System& system, const std::vector<double>& values, std::size_t candidate);
  void add_curve(const System& system, std::size_t condition);
  // A wave of this period over the condition, its size and phase free in each group.
  void add_wave(const System& system, std::size_t condition, double period);
  // Smooth random functions of one or two conditions, as many and on the same groups as the candidate has parameters:
  // the same freedom without the physics.
  void add_negative_control(const System& system, std::size_t candidate, std::size_t number, std::uint64_t seed);

  std::vector<Structure> list;
  std::vector<Signature> signatures;
  std::vector<ExtraColumn> extras;
  std::size_t signature_columns = 0;

 private:
  const CurveBasis* basis(const System& system, std::size_t condition);
  std::deque<CurveBasis> bases_, bases_of_waves_;
};

struct Projection {
  Linearisation linearisation;
  std::vector<Eigen::MatrixXd> columns_of;  // [group in play]: group_columns(), until block_scores() has read them
  std::vector<std::size_t> own;             // columns of the model's free parameters
  Eigen::MatrixXd coefficients;             // own x foreign: what the free parameters can imitate
  Eigen::MatrixXd full, surviving;          // Gram matrices of the foreign columns before and after projection
  Eigen::VectorXd score;                    // surviving columns times residual
  double squares = 0, rows = 0;             // of the whitened residual
  std::vector<std::size_t> columns(const Structures& structures, std::size_t structure) const;   // in the linearisation
  std::vector<Eigen::Index> foreign(const Structures& structures, std::size_t structure) const;  // in `surviving`
};
Projection project(const System& system, const Fit& fit, const Structures& structures);

// A direction of which less survives, as a share of its length, is not looked at.
inline constexpr double visible_share = 1e-3;

// Contributions of every block to the scores of every structure, for stats::sign_flip_test. Directions that survive
// with less than a thousandth of their length are left out.
struct BlockScores {
  std::vector<stats::ScoreFamily> families;  // one per structure
  std::size_t blocks = 0;
  double inflation = 1;           // rows over degrees of freedom
  Eigen::MatrixXd raw_surviving;  // Gram matrix of the surviving columns in the data's own unit
  Eigen::VectorXd variance;       // sum over blocks of the squared contribution to each foreign column's score
  // For each foreign column the squared score over its variance, without the three blocks that add most to it. The
  // variance is that of the bulk of blocks (median of u_b^2 / |s_b|^2 over that of chi-square with one degree).
  Eigen::VectorXd trimmed;
  double norm = 0;  // sum of Observations::norm over the rows in use
};
BlockScores block_scores(const System& system, Projection& projection, const Structures& structures);

// What sits in a few blocks (readings that clip) can be flipped in too few ways for a sign-flip test to see it: the
// chance of the largest trimmed score among all mechanisms and curves. Three blocks of dust do not move it.
double concentrated_p(const Projection& projection, const Structures& structures, const BlockScores& scores);

// Chance of the largest score, of all looks, under the stated noise alone (Rao's test); Sidak's price for looking
// often.
double stated_noise_p(const Projection& projection, const Structures& structures);

// Signatures' |cos|: how much of the smaller of two structures' subspaces the other can imitate, root mean square of
// the canonical correlations.
struct Subspace {
  std::vector<Eigen::Index> columns;
  Eigen::MatrixXd root;  // G^-1/2 of what the free parameters leave of them, on its range
  Subspace(const Projection& projection, std::vector<Eigen::Index> columns);
};
double look_alike(const Projection& projection, const Subspace& a, const Subspace& b);

// `inflation`: variance of each candidate's score over that of independent rows, by place in Problem::candidates.
// A limit is the amplitude that the test finds with 80 % power among all its looks and that matters, whichever is more.
std::vector<Isolability> isolability(const System& system, const Projection& projection, const Structures& structures,
                                     const BlockScores& scores, const std::vector<double>& inflation,
                                     const Options& options);
// Variance inflation of each candidate's score by correlation within blocks, at least 1; 0 where it has no signature.
std::vector<double> inflation(const System& system, const Projection& projection, const Structures& structures,
                              const BlockScores& scores);

// Share of the excess over noise that each curve explains, the most telling first, with the range that holds most of
// it.
std::vector<LocatedCondition> locate(const System& system, const Projection& projection, const Structures& structures);
// The final word: curves before and after, the range that holds most of the effect, its size there, and the order.
// Conditions that tell about as much as the first one stand in the order in which the named mechanisms declare them.
void place_conditions(const System& system, Explanation& explanation);
Curve residual_curve(const System& system, std::size_t condition, const std::vector<double>& before,
                     const std::vector<double>& after, std::size_t bins);

}  // namespace gonio::inference
