// Block-matrix method (simple prior-free method, SPFM): shapes of least rank, with no basis and no number of shapes.
//   min |S#|_*   subject to   W = R S,   S# F x 3P with one shape per row (Dai, Li & He, CVPR 2012; IJCV 107 (2014))
// S# has the rank K of the shapes where the 3F x P matrix S has 3K, so that its nuclear norm asks for more.
// Rotations: those of rank 3K factors (metric_upgrade), where the paper intersects the orthonormality equations with
// the positive semidefinite cone and refines the answer by the same equations. Shapes: the paper relaxes W = R S by
// mu/2 |W - R S|^2 and lets mu fall (fixed-point continuation); this is its limit, solved as it stands (low_rank.h),
// with a bound that says how near the minimum it is. Noise stays in the shapes' image coordinates. Complete data only.
#include <Eigen/Core>
#include <cstdio>

#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/low_rank.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

std::string gap_note(const LowRankShapes& found) {
  char text[160];
  std::snprintf(text, sizeof text, "nuclear norm %.6g, no more than %.2g %% above the least; rank %td",
                found.nuclear_norm, 100 * (found.nuclear_norm / std::max(found.bound, 1e-300) - 1), found.rank);
  return text;
}

class Spfm : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "spfm",
        "block-matrix method (SPFM)",
        "The shapes of all frames, one per row, have the least nuclear norm that the tracks allow.",
        "Dai, Li & He, CVPR 2012 and IJCV 107 (2014), section 5",
        Prior::shape_basis,
        false,
        true,
        false,
        {camera_rank_parameter(), free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    Solution solution;
    const Start start = start_for(info(), sequence, options, shapes_from_tracks(sequence), solution);
    LowRankOptions low_rank;
    if (options.most_iterations > 0) low_rank.most_iterations = options.most_iterations;
    const LowRankShapes found = low_rank_shapes({start.w, start.rows, {}, 0}, low_rank);
    solution.reconstruction.shapes = found.shapes;
    solution.reconstruction.rotations = start.upgrade.rotations;
    turn_to_first_camera(solution.reconstruction);
    solution.iterations = found.iterations;
    solution.converged = found.converged;
    solution.notes.push_back(gap_note(found));
    return solution;
  }
};

}  // namespace

const Solver& spfm() {
  static const Spfm solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
