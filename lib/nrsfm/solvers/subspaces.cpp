// Union of subspaces: each frame's shape is made of few others, those of the same kind of motion, and all shapes
// together have low rank.
//   min |S#|_* + (beta / 2) |D S#|_F^2   subject to   W = R S,     D = (I - C') (I - 1 1' / F),
//   C: every shape less the mean by few others (self_expression.h)
// in turns (Zhu, Huang, De la Torre & Lucey, CVPR 2014, section 3: complex motion does not fit one low-rank basis, but
// its parts do). The paper asks for C of low rank; without corruption such a C is a function of the singular vectors of
// S# alone (Favaro, Vidal & Ravichandran, CVPR 2011), which the nuclear norm judges already, so that the
// self-expression here is the sparse one. Both terms start at a ratio of `weight`. The first turn is the answer of
// spfm, with its cameras. Complete data only.
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

#include "nrsfm/factorization.h"
#include "nrsfm/low_rank.h"
#include "nrsfm/self_expression.h"
#include "nrsfm/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

// D with D S# = what of each shape, less the mean, is not a sum of the others that it goes with.
Eigen::MatrixXd apart_of(const Eigen::MatrixXd& shapes, double sparsity) {
  Eigen::MatrixXd apart = -self_expression(shapes, sparsity).transpose();
  apart.diagonal().array() += 1;
  apart.colwise() -= apart.rowwise().mean().eval();
  return apart;
}

class Subspaces : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "subspaces",
        "union of subspaces",
        "Shapes have low rank together, and each is a sum of few others: parts of a motion have bases of their own.",
        "Zhu, Huang, De la Torre & Lucey, CVPR 2014; Elhamifar & Vidal, PAMI 35 (2013)",
        Prior::subspaces,
        false,
        true,
        false,
        {camera_rank_parameter(),
         {"weight", 0.1, 0, 1000, false, "of the distance from the subspaces, against the nuclear norm"},
         {"sparsity", 5, 1.01, 10000, false, "how many times less than at which no frame helps another alpha is"},
         {"rounds", 5, 1, 50, true, "turns of shapes and subspaces"},
         free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    SolverValues values = values_in_force(info(), options.values);
    Solution solution;
    const Start start = start_for(info(), sequence, options, shapes_from_tracks(sequence), solution);
    LowRankOptions low_rank;
    if (options.most_iterations > 0) low_rank.most_iterations = options.most_iterations;
    LowRankProblem problem{start.w, start.rows, {}, 0};
    LowRankShapes found = low_rank_shapes(problem, low_rank);
    const int rounds = static_cast<int>(values.at("rounds"));
    solution.iterations = found.iterations;
    const double weight = values.at("weight");
    double change = 0;
    for (int round = 0; round < rounds && weight > 0 && found.nuclear_norm > 0; ++round) {
      const Eigen::MatrixXd rows = rearranged(found.shapes);
      const Eigen::MatrixXd apart = apart_of(rows, values.at("sparsity"));
      if (round == 0) {
        problem.coupling = 2 * weight * found.nuclear_norm / std::max((apart * rows).squaredNorm(), 1e-300);
        solution.notes.push_back(
            distance_note((apart * rows).norm() / (rows.rowwise() - rows.colwise().mean()).norm()));
      }
      problem.laplacian = apart.transpose() * apart;
      LowRankShapes next = low_rank_shapes(problem, low_rank, found.shapes);
      change = (next.shapes - found.shapes).norm() / next.shapes.norm();
      found = std::move(next);
      solution.iterations += found.iterations;
    }
    solution.converged = found.converged && change < 1e-2;
    solution.reconstruction.shapes = found.shapes;
    solution.reconstruction.rotations = start.upgrade.rotations;
    turn_to_first_camera(solution.reconstruction);
    solution.values.insert(values.begin(), values.end());
    return solution;
  }

 private:
  static std::string distance_note(double share) {
    char text[120];
    std::snprintf(text, sizeof text, "shapes of least nuclear norm lie %.3g %% off the subspaces of the others",
                  100 * share);
    return text;
  }
};

}  // namespace

const Solver& subspaces() {
  static const Subspaces solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
