// Union of subspaces: each frame's shape is made of few others, those of the same kind of motion, and all shapes
// together have low rank.
//   min |S#|_* + (beta / 2) |D S#|_F^2   subject to   W = R S,     D = (I - C') (I - 1 1' / F),
//   C: every shape less the mean by few others (self_expression.h)
// in turns (Zhu, Huang, De la Torre & Lucey, CVPR 2014, section 3: complex motion does not fit one low-rank basis, but
// its parts do). The paper asks for C of low rank; without corruption such a C is a function of the singular vectors of
// S# alone (Favaro, Vidal & Ravichandran, CVPR 2011), which the nuclear norm judges already, so that the
// self-expression here is the sparse one. How sparse the tracks say: C from half of the points has to predict the
// tracks of the other half. Both terms start at a ratio of `weight`. The first turn is the answer of spfm, with its
// cameras. Complete data only.
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/low_rank.h"
#include "nrsfm/solve/self_expression.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

constexpr double kLeastSparsity = 1.01;
constexpr std::array kSparsities{2.0, 5.0, 12.5, 30.0, 80.0};

// D with D S# = what of each shape, less the mean, is not a sum of the others that it goes with.
Eigen::MatrixXd apart_of(const Eigen::MatrixXd& shapes, double sparsity) {
  Eigen::MatrixXd apart = -self_expression(shapes, sparsity).transpose();
  apart.diagonal().array() += 1;
  apart.colwise() -= apart.rowwise().mean().eval();
  return apart;
}

// Squares of tracks that `sparsity` predicts of points which C has not seen: C from every other point, the tracks of
// the rest in frame f from their shapes in other frames.
double predicted_error(const Shapes& shapes, const Eigen::MatrixXd& tracks, const Eigen::MatrixXd& cameras,
                       double sparsity) {
  const Eigen::Index points = shapes.cols();
  double sum = 0;
  for (const Eigen::Index half : {0, 1}) {
    const Shapes seen = shapes(Eigen::all, Eigen::seq(half, points - 1, 2));
    const auto rest = Eigen::seq(1 - half, points - 1, 2);
    const Eigen::MatrixXd c = self_expression(rearranged(seen), sparsity);
    Eigen::MatrixXd others = rearranged(shapes(Eigen::all, rest));
    const Eigen::RowVectorXd mean = others.colwise().mean();
    others.rowwise() -= mean;
    const Shapes told = arranged((c.transpose() * others).rowwise() + mean);
    for (Eigen::Index f = 0; f < tracks.rows() / 2; ++f) {
      const Eigen::MatrixXd there = cameras.middleRows<2>(2 * f) * shape_of(told, f);
      sum += (tracks.middleRows<2>(2 * f)(Eigen::all, rest) - there).squaredNorm();
    }
  }
  return sum;
}

// The least sparsity that predicts tracks within 1 % of their root mean square, or their noise; else the one that
// predicts them best. Over at most 300 frames.
double sparsity_of(const Shapes& shapes, const Start& start) {
  const Eigen::Index frames = start.w.rows() / 2, taken = std::min<Eigen::Index>(frames, 300);
  Shapes some(3 * taken, shapes.cols());
  Eigen::MatrixXd tracks(2 * taken, shapes.cols()), cameras(2 * taken, 3);
  for (Eigen::Index k = 0; k < taken; ++k) {
    const Eigen::Index f = k * frames / taken;
    shape_of(some, k) = shape_of(shapes, f);
    tracks.middleRows<2>(2 * k) = start.w.middleRows<2>(2 * f);
    cameras.middleRows<2>(2 * k) = start.rows.middleRows<2>(2 * f);
  }
  const double noise = std::pow(noise_of(start.w), 2) * static_cast<double>(tracks.size());
  const double enough = std::max(1e-4 * tracks.squaredNorm(), noise);
  double best = kSparsities.front(), least = std::numeric_limits<double>::infinity();
  for (const double sparsity : kSparsities) {
    const double error = predicted_error(some, tracks, cameras, sparsity);
    if (error < least) best = sparsity;
    least = std::min(least, error);
    if (error <= enough) break;
  }
  return best;
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
         {"sparsity", 0, 0, 10000, false,
          "how many times less than at which no frame helps another alpha is; 0: from points left out"},
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
    if (values.at("sparsity") == 0) values["sparsity"] = sparsity_of(found.shapes, start);
    values["sparsity"] = std::max(values.at("sparsity"), kLeastSparsity);
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
