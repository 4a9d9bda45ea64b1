// Complementary rank-3 spaces (CSF2): basis shapes explain one after the other what the shapes before them leave.
//   S_1 = M_1^+ W,  S_k = M_k^+ (W - M_1 S_1 - .. - M_(k-1) S_(k-1)),   M_k = diag(c_fk) D 2F x 3,   C = Omega_d X
// c_f1 = 1: S_1 is the rigid shape, and what deforms is held to its residual, which keeps basis shapes from cancelling
// each other in depth as general rank-3K factors may. X minimizes the reprojection error over visible tracks (Gotardo &
// Martinez, CVPR 2011, "Non-rigid structure from motion with complementary rank-3 spaces"; the equations are derived
// here from that model, see shape_trajectory.h). Rotations as in csf. The error has many minima: more cosines may end
// higher than few. Two starts: the first K cosines, as in csf; and csf's answer, its weights turned to a constant and
// the principal coordinates of its shapes. In these weights are uncorrelated, so that M_j' M_k is near 0 and basis
// shapes fitted one by one are near those fitted together. The second goes on where it leaves clearly less after a few
// steps. Left out: the paper's growth of d in rounds.
#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/principal_curve.h"
#include "nrsfm/solve/shape_trajectory.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

constexpr int kStepsOfEachStart = 20;
constexpr double kClearly = 0.9;  // of the error

ShapeTrajectory tried(ShapeTrajectoryProblem problem, Eigen::VectorXd translation, bool complementary,
                      const Eigen::MatrixXd& from) {
  problem.complementary = complementary;
  problem.held = complementary ? 1 : 0;
  problem.most_iterations = kStepsOfEachStart;
  return fit_with_translation(problem, from, translation);
}

ShapeTrajectory better_start(const ShapeTrajectoryProblem& problem, const Eigen::VectorXd& translation,
                             const Eigen::MatrixXd& cosines) {
  const Eigen::Index terms = cosines.cols();
  const ShapeTrajectory plain = tried(problem, translation, true, cosines);
  if (terms < 2) return plain;
  const ShapeTrajectory smooth = tried(problem, translation, false, cosines);
  Eigen::MatrixXd principal = cosines;
  principal.rightCols(terms - 1) = problem.omega.transpose() * principal_coordinates(smooth, terms - 1);
  principal.rightCols(terms - 1).colwise().normalize();
  const ShapeTrajectory turned = tried(problem, translation, true, principal);
  return turned.cost < kClearly * kClearly * plain.cost ? turned : plain;
}

class Csf2 : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "csf2",
        "complementary rank-3 spaces (CSF2)",
        "As csf, each basis shape fitted to what the shapes before it leave; the first is the rigid shape.",
        "Gotardo & Martinez, CVPR 2011 (complementary rank-3 spaces)",
        Prior::shape_and_trajectory,
        true,
        true,
        false,
        {rank_parameter("basis shapes, K"), dct_terms_parameter(), camera_rank_parameter(), free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    const Eigen::Index rank = shapes_of_model(info(), sequence, options);
    const Eigen::Index d = dct_terms_of(info(), sequence, options, rank);
    Solution solution;
    Start start = start_for(info(), sequence, options, rank, solution);
    ShapeTrajectoryProblem problem = linear_problem(sequence, start, d);
    const ShapeTrajectory begun = better_start(problem, start.translation, Eigen::MatrixXd::Identity(d, rank));
    problem.complementary = true;
    problem.held = 1;
    if (options.most_iterations > 0) problem.most_iterations = options.most_iterations;
    const ShapeTrajectory fit = fit_with_translation(problem, begun.x, start.translation);
    fill(start, fit, solution);
    solution.iterations += begun.iterations;
    solution.values["rank"] = static_cast<double>(rank);
    solution.values["dct_terms"] = static_cast<double>(d);
    return solution;
  }
};

}  // namespace

const Solver& csf2() {
  static const Csf2 solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
