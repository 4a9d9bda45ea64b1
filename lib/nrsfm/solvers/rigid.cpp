// Rigid factorization: one shape for the whole sequence, seen by orthographic or weak-perspective cameras.
//   W = M S + t 1',  M = [s_f R_f] 2F x 3 (Tomasi & Kanade 1992; scales: Poelman & Kanade 1997)
// The rank-3 factors of W (missing entries completed at rank 3), their metric upgrade, and the shape that visible
// tracks then want. Rank 3 alone does not hold the rows of M to rotations: refine=1 goes on to the least reprojection
// error over cameras and shape (rigid_motion.h), the likeliest answer for independent normal errors. It is not the
// preset because tracks of a shape that deforms are not of that kind: there a smaller reprojection error buys rotations
// too small and depths too large (bas-relief).
#include <Eigen/Core>

#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/rigid_motion.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

class Rigid : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "rigid",
        "rigid factorization",
        "One shape that does not deform; least reprojection error over rotations, scales and points.",
        "Tomasi & Kanade, IJCV 9 (1992), sections 3 and 4; Poelman & Kanade, PAMI 19 (1997)",
        Prior::rigid,
        true,
        true,
        false,
        {{"refine", 0, 0, 1, true, "1: go on to the least reprojection error; 0: factorization alone"},
         free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    const bool free_scales = free_scales_of(info(), sequence, options);
    const Start start = start_from(sequence, 1, {free_scales, options.seed});
    Solution solution;
    RigidMotion motion;
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      motion.cameras.push_back({start.upgrade.rotations[static_cast<std::size_t>(f)], start.upgrade.scales(f),
                                start.translation.segment<2>(2 * f)});
    }
    const bool refine = values_in_force(info(), options.values).at("refine") > 0;
    if (refine) {
      RigidOptions search{.free_scales = free_scales};
      if (options.most_iterations > 0) search.most_iterations = options.most_iterations;
      motion = refine_rigid(sequence, motion.cameras, search);
      solution.iterations = motion.iterations;
      solution.converged = motion.converged;
    } else {
      motion.shape = rigid_shape(sequence, motion.cameras);
    }
    solution.values = {{"refine", refine ? 1 : 0}, {"free_scales", free_scales ? 1 : 0}};
    fill(sequence, motion, solution.reconstruction);
    return solution;
  }

 private:
  static void fill(const Sequence& sequence, const RigidMotion& motion, Reconstruction& answer) {
    answer.shapes.resize(3 * sequence.frames(), sequence.points());
    const Eigen::Vector3d middle = motion.shape.rowwise().mean();
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      shape_of(answer.shapes, f) = motion.shape.colwise() - middle;
      answer.rotations.push_back(motion.cameras[static_cast<std::size_t>(f)].rotation);
    }
    turn_to_first_camera(answer);
  }
};

}  // namespace

const Solver& rigid() {
  static const Rigid solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
