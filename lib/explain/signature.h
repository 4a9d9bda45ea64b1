// What mechanisms, free curves and dummies look like in the recordings once the free parameters of a model are
// projected out: isolability, the null test and location all read from this projection.
#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "explain/fit.h"
#include "stats/sign_flip.h"

namespace gonio::explain {

// One thing that could structure the residuals: a mechanism, a curve over one condition, or a dummy.
struct Structure {
  enum class Kind { mechanism, curve, dummy };
  Kind kind = Kind::mechanism;
  std::size_t index = 0;  // candidate, condition, or number of the dummy
  std::string name;
  std::size_t first = 0, count = 0;  // its columns among all signature parameters, or among all extras
  std::size_t shape = 0;             // dummies: the candidate whose freedom it has
};

// The columns of all structures, as extras and signatures that linearise() understands. Not copyable: extras point at
// bases.
class Structures {
 public:
  Structures() = default;
  Structures(const Structures&) = delete;
  Structures& operator=(const Structures&) = delete;
  void add_mechanism(const System& system, const std::vector<double>& values, std::size_t candidate);
  void add_curve(const System& system, std::size_t condition);
  // Smooth random functions of one or two conditions, as many and on the same groups as the candidate has parameters:
  // the same freedom without the physics.
  void add_dummy(const System& system, std::size_t candidate, std::size_t number, std::uint64_t seed);

  std::vector<Structure> list;
  std::vector<Signature> signatures;
  std::vector<ExtraColumn> extras;
  std::size_t signature_columns = 0;

 private:
  const CurveBasis* basis(const System& system, std::size_t condition);
  std::deque<CurveBasis> bases_;
};

struct Projection {
  Linearisation linearisation;
  std::vector<std::size_t> own;     // columns of the model's free parameters
  Eigen::MatrixXd coefficients;     // own x foreign: what the free parameters can imitate
  Eigen::MatrixXd full, surviving;  // Gram matrices of the foreign columns before and after projection
  Eigen::VectorXd score;            // surviving columns times residual
  double squares = 0, rows = 0;     // of the whitened residual
  std::vector<std::size_t> columns(const Structures& structures, std::size_t structure) const;   // in the linearisation
  std::vector<Eigen::Index> foreign(const Structures& structures, std::size_t structure) const;  // in `surviving`
};
Projection project(const System& system, const Fit& fit, const Structures& structures);

// Contributions of every block to the scores of every structure, for stats::sign_flip_test. Directions that survive
// with less than a thousandth of their length are left out.
struct BlockScores {
  std::vector<stats::ScoreFamily> families;  // one per structure
  std::size_t blocks = 0;
  double inflation = 1;           // rows over degrees of freedom
  Eigen::MatrixXd raw_surviving;  // Gram matrix of the surviving columns in the data's own unit
  double norm = 0;                // sum of Observations::norm over the rows in use
};
BlockScores block_scores(const System& system, const Projection& projection, const Structures& structures);

std::vector<Isolability> isolability(const System& system, const Projection& projection, const Structures& structures,
                                     double level);

// Share of the excess over noise that each curve explains, the most telling first, with the range that holds most of
// it.
std::vector<LocatedCondition> locate(const System& system, const Projection& projection, const Structures& structures);
Curve residual_curve(const System& system, std::size_t condition, const std::vector<double>& before,
                     const std::vector<double>& after, std::size_t bins);

}  // namespace gonio::explain
