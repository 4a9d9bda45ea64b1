// Column space fitting: shapes are combinations of K basis shapes whose weights are smooth curves over time.
//   W = D (C (x) I_3) S,   C = Omega_d X,   d > K cosines, X d x K free, D = blockdiag(s_f R_f) known
// Rotations come from orthonormality at rank `camera_rank`; X starts as the first K cosines, where the model is the
// trajectory basis of rank K, and minimizes the reprojection error over visible tracks with S eliminated (Gotardo &
// Martinez, PAMI 33, 2011, "Computing smooth time-trajectories for camera and deformable shape in structure from motion
// with occlusion", sections 3 and 4). Left out: the paper's own smooth fit of the cameras' columns, in whose place
// missing tracks are completed at low rank before rotations are estimated.
#include <algorithm>
#include <cmath>

#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/shape_trajectory.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

class Csf : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "csf",
        "column space fitting (CSF)",
        "Shapes combine K basis shapes with weights that are sums of d cosines over time; least reprojection error.",
        "Gotardo & Martinez, PAMI 33 (2011), sections 3 and 4",
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
    if (options.most_iterations > 0) problem.most_iterations = options.most_iterations;
    const ShapeTrajectory fit = fit_with_translation(problem, Eigen::MatrixXd::Identity(d, rank), start.translation);
    fill(start, fit, solution);
    solution.values["rank"] = static_cast<double>(rank);
    solution.values["dct_terms"] = static_cast<double>(d);
    return solution;
  }
};

}  // namespace

const Solver& csf() {
  static const Csf solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
