// Trajectory basis (point trajectory approach, PTA): every coordinate of every point moves as a sum of K smooth curves.
//   S = (Theta (x) I_3) A,   Theta F x K of the DCT,   W = R S = L A,   L_f = [theta_f1 R_f .. theta_fK R_f]
// L is 2F x 3K: W has rank 3K, and the three columns of L that belong to the constant curve are the rotations but for a
// factor. So the 3K x 3 corrective transform that makes the rows of W's left factor orthonormal gives the rotations
// (metric_upgrade); L follows from them, and A = L^+ W (Akhter, Sheikh, Khan & Kanade, NIPS 2008; PAMI 2011).
#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "linear/qr.h"
#include "linear/symmetric_eigen.h"
#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

constexpr double kMostCondition = 10;  // of L, where K is chosen: beyond it errors of the tracks become depth

Eigen::MatrixXd trajectories_of(const Start& start, Eigen::Index terms) {
  const Eigen::Index frames = start.rows.rows() / 2;
  const Eigen::MatrixXd theta = dct_basis(frames, terms);
  Eigen::MatrixXd trajectories(2 * frames, 3 * terms);
  for (Eigen::Index f = 0; f < frames; ++f) {
    for (Eigen::Index k = 0; k < terms; ++k) {
      trajectories.block<2, 3>(2 * f, 3 * k) = theta(f, k) * start.rows.middleRows<2>(2 * f);
    }
  }
  return trajectories;
}

double condition_of(const Eigen::MatrixXd& a) {
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(a.transpose() * a, Eigen::EigenvaluesOnly);
  const double least = eigen.eigenvalues()(0), most = eigen.eigenvalues()(eigen.eigenvalues().size() - 1);
  return least > 0 ? std::sqrt(most / least) : std::numeric_limits<double>::infinity();
}

class Pta : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "pta",
        "trajectory basis (PTA)",
        "Points move along sums of K cosines over time; rotations from orthonormality, shapes by least squares.",
        "Akhter, Sheikh, Khan & Kanade, NIPS 2008 and PAMI 33 (2011)",
        Prior::trajectory_basis,
        false,
        true,
        false,
        {{"terms", 0, 0, 200, true,
          "curves per coordinate, K; 0: as many as tracks need and the camera's motion supports"},
         camera_rank_parameter(),
         free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    const bool given = values_in_force(info(), options.values).at("terms") > 0;
    Eigen::Index terms = terms_of(info(), sequence, options, "terms", 1e-3, 40);
    Solution solution;
    SolverOptions cameras = options;  // where the user chose K, the rotations are those of K, as in the paper
    if (given) cameras.values.try_emplace("camera_rank", static_cast<double>(terms));
    const Eigen::Index trial = given ? terms : terms_of(info(), sequence, options, "terms", 1e-2, 40);
    const Start start = start_for(info(), sequence, cameras, trial, solution);
    while (!given && terms > 1 && condition_of(trajectories_of(start, terms)) > kMostCondition) --terms;
    const Eigen::MatrixXd theta = dct_basis(sequence.frames(), terms), trajectories = trajectories_of(start, terms);
    const linear::LeastNorm qr(trajectories);  // least norm where not determined
    if (qr.rank() < 3 * terms) {
      solution.notes.push_back("the camera's motion does not determine " + std::to_string(3 * terms - qr.rank()) +
                               " of " + std::to_string(3 * terms) + " coefficients of each point");
    }
    solution.reconstruction.shapes = shapes_of(theta, qr.solve(start.w));
    solution.reconstruction.rotations = start.upgrade.rotations;
    turn_to_first_camera(solution.reconstruction);
    solution.values["terms"] = static_cast<double>(terms);
    return solution;
  }
};

}  // namespace

const Solver& pta() {
  static const Pta solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
